// Media around eye and lamp; the lamp of the atmosphere dims in it; glass that is not hollow.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 2, -8> look_at <0, 1, 0> angle 45 }
 light_source { <-2, 4, 2>, <1.5, 1.2, 1> fade_distance 4 fade_power 2 media_attenuation on }
box { <-5, 0, -9>, <5, 6, 6> hollow pigment { checker rgb .9 rgb .4 } }

media { scattering { 2, <.03, .03, .05> } absorption .02 samples 60 }
box { <1, 0, 0>, <3, 2, 1> hollow pigment { rgbt 1 } interior { media { absorption .8 } } }
sphere { <-1, 1, -1>, 1 pigment { rgbt <1, 1, 1, .9> } }
