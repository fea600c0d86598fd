// Mirrors: plain, metallic, by angle, Fresnel, in each other.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 3, -8> look_at <0, 1, 0> angle 50 }
light_source { <5, 9, -7>, 1 }
background { rgb <.2, .3, .5> }
plane { y, 0 pigment { checker rgb .9 rgb .15 } }
sphere { <-2.4, 1, 0>, 1 pigment { rgb <.9, .6, .2> } finish { reflection .6 diffuse .3 } }
sphere { <0, 1, 1>, 1 pigment { rgb <.9, .6, .2> } finish { reflection { .8 metallic } diffuse .2 } }
sphere { <2.4, 1, 0>, 1 pigment { rgb <.1, .1, .3> } finish { reflection { 0, 1 falloff 3 } } }
sphere { <-1, .5, -2>, .5 pigment { rgb .1 } finish { reflection { 0, 1 fresnel on } conserve_energy } interior { ior 1.5 } }
box { <.4, 0, -2.6>, <1.4, .8, -1.8> pigment { rgb <.2, .6, .3> } finish { reflection { .3 exponent .8 } } }
