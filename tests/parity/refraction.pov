// Glass without photons: refraction, absorption and coloured shadows.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 3, -8> look_at <0, .9, 0> angle 45 }
light_source { <5, 9, -7>, 1 }
sky_sphere { pigment { gradient y color_map { [0 rgb <.7, .8, .9>] [1 rgb <.2, .4, .8>] } } }
plane { y, 0 pigment { checker rgb <.9, .9, .8> rgb <.3, .4, .3> scale .7 } }
sphere { <-1.8, 1, 0>, 1 pigment { rgbf <1, 1, 1, .95> } finish { diffuse 0 ambient 0 specular .5 reflection .08 } interior { ior 1.5 } }
box { <.2, .01, -.8>, <1.6, 1.4, .6> pigment { rgbf <.4, .9, .6, .9> } finish { diffuse .1 } interior { ior 1.3 } rotate 20 * y }
cylinder { <2.6, .01, 0>, <2.6, 1.5, 0>, .6
  pigment { rgbt <1, 1, 1, 1> } interior { ior 1.33 fade_distance .6 fade_power 1001 fade_color <.9, .4, .1> } }
