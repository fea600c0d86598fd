// clipped_by, bounded_by, inverse and interior surfaces.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 3, -8> look_at <0, .9, 0> angle 46 }
light_source { <4, 8, -6>, 1 }
plane { y, 0 pigment { rgb <.7, .75, .8> } }
sphere { <-2.2, 1, 0>, 1 clipped_by { plane { x + y, -1 } } pigment { rgb <.9, .4, .3> } }
sphere { <0, 1, 0>, 1 clipped_by { box { <-1, 0, -1>, <1, 1.4, .2> } } bounded_by { clipped_by } pigment { rgb <.3, .7, .4> } }
cylinder { <2.2, 0, 0>, <2.2, 2, 0>, .8 open clipped_by { plane { z, .2 inverse } } pigment { rgb <.4, .5, .9> } }
difference { sphere { <.9, .5, -2.5>, .5 } plane { z, -2.6 } bounded_by { sphere { <.9, .5, -2.5>, .51 } } pigment { rgb <.9, .8, .3> } }
