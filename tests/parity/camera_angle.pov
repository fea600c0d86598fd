// A wide camera with sky, right and up of its own, rolled and moved.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { up .75 * y right -1.1 * x sky <.3, 1, .1> angle 95 location <1, 2, -4> look_at <-.5, .8, 1> translate <.2, .3, 0> }
light_source { <-3, 9, -6>, 1 }
background { rgb <.1, .15, .3> }
plane { y, 0 pigment { checker rgb .8 rgb <.6, .3, .3> } }
#declare I = 0;
#while (I < 8)
  sphere { <3 * cos(I), .5, 3 * sin(I)>, .5 pigment { rgb <I / 8, .5, 1 - I / 8> } }
  #declare I = I + 1;
#end
