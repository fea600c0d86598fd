// A scene of an old language version, without gamma.
#version 3.5;
camera { location <0, 3, -8> look_at <0, .9, 0> angle 46 }
light_source { <4, 8, -6>, 1 }
plane { y, 0 pigment { checker rgb .8 rgb .3 } }
sphere { <-1.5, 1, 0>, 1 pigment { rgb <.9, .4, .3> } finish { phong .8 ambient .2 } }
sphere { <1.5, 1, 0>, 1 pigment { rgbf <.6, .9, .7, .8> } finish { reflection .2 } interior { ior 1.4 } }
