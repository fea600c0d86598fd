// interior_texture of open shapes, and a light inside one.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 4, -8> look_at <0, .9, 0> angle 46 }
light_source { <4, 8, -6>, .7 }
light_source { <-2, .8, 0>, <.6, .5, .3> }
plane { y, 0 pigment { rgb .7 } }
cylinder { <-2, 0, 0>, <-2, 1.6, 0>, .9 open texture { pigment { rgb <.8, .3, .3> } } interior_texture { pigment { rgb <.3, .8, .3> } } }
cone { <1.6, 0, 0>, .3, <1.6, 1.5, 0>, 1 open texture { pigment { rgb <.3, .3, .8> } } interior_texture { pigment { rgb <.9, .8, .3> } finish { phong .5 } } }
