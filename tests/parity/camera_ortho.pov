// An orthographic camera that is turned and not square.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { orthographic location <4, 5, -8> right 7 * x up 5.25 * y look_at <0, .5, 0> }
light_source { <-3, 9, -6>, 1 }
plane { y, 0 pigment { checker rgb .8 rgb <.3, .5, .6> } }
sphere { <0, 1, 0>, 1 pigment { rgb <.9, .5, .3> } }
box { <-2.5, 0, 1>, <-1.5, 2, 2> pigment { rgb <.5, .8, .4> } }
