// Filter and transmit, seen through and in shadows.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 4, -8> look_at <0, .8, 0> angle 48 }
light_source { <3, 9, -6>, 1 }
plane { y, 0 pigment { rgb .9 } }
box { <-3, 0, -1>, <-2.9, 2, 1> pigment { rgbf <1, .2, .2, .8> } }
box { <-1.6, 0, -1>, <-1.5, 2, 1> pigment { rgbt <.2, 1, .2, .5> } }
box { <-.2, 0, -1>, <-.1, 2, 1> pigment { rgbft <.2, .4, 1, .5, .3> } }
sphere { <1.6, 1, 0>, .9 pigment { rgbf <1, .9, .1, .7> } hollow }
sphere { <1.6, 1, 0>, .4 pigment { rgb <.7, .2, .6> } }
disc { <3.4, 1, 0>, -x, .9 pigment { rgbt <1, 1, 1, .6> } }
