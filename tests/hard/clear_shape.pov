// A shape that lets all light through and does not bend it, before coloured walls; or (Sound) nothing.
// SPDX-License-Identifier: Apache-2.0
#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 60 }
#ifndef (Shape) #declare Shape = 1; #end
#ifndef (Sound) #declare Sound = 0; #end
#include "every_shape.inc"
camera { location <1.13, 1.71, -3.97> right x*4/3 angle 38 look_at <0, -0.15, 0.1> }
light_source { <-3.1, 6.3, -4.2>, rgb 1 }
plane { y, -1.003 pigment { checker rgb 0.85, rgb 0.3 translate <0.37, 0.5, 0.21> scale 0.7 } finish { ambient 0.1 diffuse 0.8 } }
#if (!Sound)
  object { Every_Shape(Shape) pigment { rgbt 1 } finish { ambient 0 diffuse 0 } interior { ior 1 } }
#end
