// A bow that fades at its ends.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 2, -8> look_at <0, 1, 0> angle 45 }
 light_source { <3, 8, -6>, 1 }
plane { y, 0 pigment { checker rgb .9 rgb .4 } }

background { rgb <.3, .5, .9> }
rainbow { direction <0, -.2, 1> angle 24 width 6 distance 6 arc_angle 200 falloff_angle 80
  color_map { [0 rgbf <1, 0, 1, .3>] [.3 rgbf <0, 0, 1, .8>] [.6 rgbt <0, 1, 0, .6>] [1 rgbft <1, 0, 0, .3, .8>] } }
rainbow { direction <0, -.2, 1> angle 33 width 3 distance 9 color_map { [0 rgbt <1, 0, 0, .5>] [1 rgbt <0, 0, 1, .5>] } }
