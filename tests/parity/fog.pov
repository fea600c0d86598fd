// Two fogs, one on the ground.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 2, -8> look_at <0, 1, 0> angle 45 }
 light_source { <3, 8, -6>, 1 }
plane { y, 0 pigment { checker rgb .9 rgb .4 } }

background { rgb <.3, .5, .9> }
sphere { <0, 1, 0>, 1 pigment { rgb <.8, .3, .2> } finish { reflection .3 } }
cylinder { <3, 0, 12>, <3, 9, 12>, 1 pigment { rgb <.3, .8, .2> } }
fog { distance 40 rgbft <.7, .7, .8, .2, .1> }
fog { fog_type 2 distance 8 fog_alt .6 fog_offset .2 rgb <.9, .9, .8> }
