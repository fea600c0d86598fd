// Scale, rotate, translate and matrix, on shapes, groups and pigments.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 3, -9> look_at <0, .7, 0> angle 48 }
light_source { <-4, 8, -6>, 1 }
plane { y, 0 pigment { checker rgb .8 rgb .4 rotate 30 * y } }
#declare Thing = union { sphere { 0, .6 } cone { 0, .5, 1.4 * y, 0 } pigment { gradient y color_map { [0 rgb <.9, .3, .2>] [1 rgb <.2, .3, .9>] } } }
object { Thing scale <1.4, .5, 1> translate <-3, .6, 0> }
object { Thing rotate <0, 0, 60> translate <-1, .7, 0> }
object { Thing matrix <1, .3, 0, 0, 1, 0, .4, 0, 1, 1, .6, 0> }
object { Thing scale <-1, 1, .4> rotate <20, 50, 30> translate <3, .8, 0> }
torus { .6, .2 scale <1, 2.5, .7> rotate 80 * x translate <0, 1, 3> pigment { rgb <.9, .8, .3> } }
