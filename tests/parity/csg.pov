// Union, intersection, difference, merge and inverse, nested and turned.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 5, -9> look_at <0, .8, 0> angle 45 }
light_source { <-6, 10, -8>, <1, 1, .9> }
light_source { <8, 4, -3>, .3 }
plane { y, 0 pigment { rgb .7 } }
difference {
  box { -1, 1 }
  sphere { 0, 1.25 pigment { rgb <.9, .7, .2> } }
  cylinder { -2 * y, 2 * y, .4 }
  pigment { rgb <.2, .5, .9> }
  rotate 25 * y translate <-2.5, 1, 0>
}
intersection {
  sphere { <-.5, 0, 0>, 1 } sphere { <.5, 0, 0>, 1 }
  box { <-2, -.8, -2>, <2, .8, 2> inverse inverse }
  pigment { rgb <.9, .3, .3> } rotate <0, -60, 10> translate <0, 1, 1>
}
merge {
  sphere { 0, .7 } cylinder { 0, 2 * x, .3 }
  pigment { rgb <.4, .9, .5> transmit .6 } translate <1.4, .8, -1.5>
}
union {
  sphere { 0, .7 } cylinder { 0, 2 * x, .3 }
  pigment { rgb <.4, .9, .5> transmit .6 } translate <1.4, .8, .8>
}
difference {
  union { cylinder { 0, 1.5 * y, .6 } torus { .6, .2 translate 1.5 * y } }
  intersection { cylinder { .2 * y, 3 * y, .45 } plane { -x, .2 } }
  plane { z, -.3 }
  pigment { rgb <.8, .6, .9> } translate <-1, 0, -2.6>
}
