// One shape of the list on a checkered floor, in one light; the whole scene scaled, shifted and
// turned, and the shape's numbers nudged, as declared.
// SPDX-License-Identifier: Apache-2.0
#version 3.7;
global_settings { assumed_gamma 1 }
#ifndef (Shape) #declare Shape = 1; #end
#ifndef (Glass) #declare Glass = 0; #end
#ifndef (Scale) #declare Scale = 1; #end
#ifndef (Away) #declare Away = 0; #end
#ifndef (Turn) #declare Turn = 0; #end
#ifndef (Nudge) #declare Nudge = 0; #end
#declare U = 1 + Nudge;
#declare Turns = <Turn, 0.7*Turn, 1.9*Turn>;
#declare Shift = Away*<0.6, -0.48, 0.64>;
#declare Place = transform { scale Scale rotate Turns translate Shift }
#macro Put (P) (vrotate(P*Scale, Turns) + Shift) #end
#include "every_shape.inc"

#ifdef (Far)
  // the same rays from further away
  camera {
    orthographic location Put(<1.13, 1.71, -3.97>/4.4713*Far) sky vrotate(y, Turns)
    right x*4*Scale up y*3*Scale direction z look_at Put(0)
  }
#else
  camera { location Put(<1.13, 1.71, -3.97>) sky vrotate(y, Turns) right x*4/3 angle 38 look_at Put(<0, -0.15, 0.1>) }
#end
light_source { Put(<-3.1, 6.3, -4.2>), rgb 1 }
background { rgb <0.3, 0.4, 0.6> }
plane {
  y, -1.003
  pigment { checker rgb 0.85, rgb 0.3 translate <0.37, 0.5, 0.21> scale 0.7 }
  finish { ambient 0.1 diffuse 0.8 }
  transform Place
}
object {
  Every_Shape(Shape)
  #if (Glass)
    pigment { rgbt <1, 1, 1, 0.95> }
    finish { ambient 0 diffuse 0.1 reflection { 0.05 } specular 0.5 }
    interior { ior 1.5 }
  #else
    pigment { rgb <0.9, 0.5, 0.3> }
    finish { ambient 0.1 diffuse 0.7 specular 0.4 roughness 0.02 }
  #end
  transform Place
}
