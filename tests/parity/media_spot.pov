// A spotlight in smoke, with a ball in its beam.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 2, -8> look_at <0, 1, 0> angle 45 }
 light_source { <-3, 5, 0>, 4 spotlight point_at <1, 0, 0> radius 12 falloff 18 }
box { <-5, 0, -9>, <5, 7, 6> hollow pigment { checker rgb .9 rgb .4 } }

media { scattering { 1, .04 extinction .5 } intervals 1 samples 60 }
sphere { <-.6, 2, 0>, .5 pigment { rgb <.8, .3, .2> } }
