// no_shadow, no_image, no_reflection, double_illuminate.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 3, -8> look_at <0, .9, 0> angle 46 }
light_source { <4, 8, -6>, 1 }
plane { y, 0 pigment { rgb .7 } finish { reflection .3 } }
sphere { <-2.4, 1, 0>, .8 pigment { rgb <.9, .3, .3> } no_shadow }
sphere { <0, 1, 0>, .8 pigment { rgb <.3, .9, .3> } no_image }
sphere { <2.4, 1, 0>, .8 pigment { rgb <.3, .3, .9> } no_reflection }
disc { <0, 2.5, 1>, <.3, .2, 1>, .8 pigment { rgb <.9, .9, .5> } double_illuminate }
