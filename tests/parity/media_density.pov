// Densities: gradients, checkers, maps, several multiplied.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 2, -8> look_at <0, 1, 0> angle 45 }
 light_source { <3, 8, -6>, 1 }
plane { y, 0 pigment { checker rgb .9 rgb .4 } }

box { <-3, 0, -1>, <-1.2, 2.5, 1> hollow pigment { rgbt 1 } interior { media { absorption 1 samples 60 density { gradient y color_map { [0 rgb 1] [1 rgb 0] } scale 2.5 } } } }
box { <-.9, 0, -1>, <.9, 2.5, 1> hollow pigment { rgbt 1 } interior { media { emission 1 samples 60 density { checker density { rgb .6 } density { rgb <0, .1, .1> } scale .5 rotate 20*y } } } }
box { <1.2, 0, -1>, <3, 2.5, 1> hollow pigment { rgbt 1 } interior { media { emission .5 absorption .2 samples 60
  density { gradient x density_map { [0 rgb .2] [.5 gradient y] [1 rgb <1, .5, 0>] } } density { gradient z sine_wave } } } }
