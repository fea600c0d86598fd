// An area light without jitter, adaptive and not.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 4, -8> look_at <0, .7, 0> angle 50 }
plane { y, 0 pigment { rgb .8 } }
sphere { <-1.5, 1, 0>, 1 pigment { rgb <.8, .3, .3> } }
box { <.6, 0, -.6>, <1.8, 1.8, .6> pigment { rgb <.3, .5, .8> } }
light_source { <4, 7, -4>, .6 area_light 2 * x, 2 * z, 5, 5 }
light_source { <-5, 6, -2>, .4 area_light <1, 0, 1>, 1.5 * y, 5, 5 adaptive 1 }
