// A convex body alone in grazing light; or (Sound) one that casts no shadow.  What faces the light is lit.
// SPDX-License-Identifier: Apache-2.0
#version 3.7;
global_settings { assumed_gamma 1 }
#ifndef (Shape) #declare Shape = 1; #end
#ifndef (Sound) #declare Sound = 0; #end
#include "every_shape.inc"
camera { location <1.13, 1.71, -3.97> right x*4/3 angle 38 look_at <0, -0.15, 0.1> }
light_source { <7.1, 2.3, 3.2>, rgb 1.5 }
light_source { <-6.1, -0.3, 1.2>, rgb <0.5, 1, 2> }
object {
  Every_Shape(Shape)
  pigment { rgb 1 }
  finish { ambient 0 diffuse 1 }
  #if (Sound) no_shadow #end
}
