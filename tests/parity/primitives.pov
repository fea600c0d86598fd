// Every primitive once, plain finish.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 4, -9> look_at <0, .6, 0> angle 50 }
light_source { <6, 10, -8>, 1 }
plane { y, 0 pigment { rgb <.5, .55, .6> } }
sphere { <-3, 1, 0>, 1 pigment { rgb <.9, .2, .2> } }
box { <-1.6, 0, -.7>, <-.3, 1.4, .7> pigment { rgb <.2, .8, .3> } }
cylinder { <.8, 0, 0>, <.8, 1.7, .3>, .6 pigment { rgb <.2, .3, .9> } }
cylinder { <2.2, 0, .8>, <2.4, 1.5, 1>, .4 open pigment { rgb <.9, .8, .2> } }
cone { <3, 0, -1>, .8, <3, 1.8, -1>, .1 pigment { rgb <.8, .4, .9> } }
cone { <-3, 0, -2.6>, .7, <-3, .9, -2.6>, .3 open pigment { rgb <.4, .9, .9> } }
torus { .8, .25 translate <0, .25, -2.5> pigment { rgb <1, .6, .3> } }
torus { .6, .5 rotate <70, 0, 20> translate <1, 1.2, 2.5> pigment { rgb <.7, .7, .7> } }
disc { <2, .3, -3>, <.2, 1, -.4>, .8, .3 pigment { rgb <.9, .9, .5> } }
triangle { <-4.5, 0, 2>, <-2.5, 0, 3>, <-3.5, 2.8, 2.4> pigment { rgb <.6, .9, .4> } }
