// A lamp in an opaque body, which lights nothing outside; or (Sound) none at all.
// SPDX-License-Identifier: Apache-2.0
#version 3.7;
global_settings { assumed_gamma 1 }
#ifndef (Shape) #declare Shape = 1; #end
#ifndef (Sound) #declare Sound = 0; #end
#include "every_shape.inc"
camera { location <1.13, 1.71, -3.97> right x*4/3 angle 38 look_at <0, -0.15, 0.1> }
light_source { <9, 9, -3>, rgb 0.1 }
#if (!Sound) light_source { <0.017, -0.013, 0.031>, rgb 40 } #end
plane { y, -1.003 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }
object { Every_Shape(Shape) pigment { rgb 0.5 } finish { ambient 0 diffuse 1 } }
