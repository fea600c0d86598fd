// Lamps behind walls: no light comes through; or (Sound) there are no lamps.
// SPDX-License-Identifier: Apache-2.0
#version 3.7;
#ifndef (Case) #declare Case = 1; #end
#ifndef (Sound) #declare Sound = 0; #end
global_settings { assumed_gamma 1 max_trace_level 6 #if (Case > 6) photons { count 20000 } #end }
camera { location <1.13, 1.71, -3.97> right x*4/3 angle 38 look_at <0, -0.15, 0.1> }
light_source { <-9, 9, -3>, rgb 0.1 }
#default { finish { ambient 0 diffuse 1 } pigment { rgb 1 } }
#macro Lamp (P, C) #if (!Sound) light_source { P, rgb C } #end #end
#declare Rows = 30; #declare Columns = 60;
#macro Corner (I, J) vrotate(vrotate(0.9*y, x*180*I/Rows), y*360*J/Columns) #end
#if (Case != 7) plane { y, -1.003 } #end

#switch (Case)
#case (1) // a lamp in a room with walls of 1e-6; 0
  Lamp(<0.1, 0.2, -0.1>, 50)
  difference { box { -0.8, 0.8 } box { -0.8 + 1e-6, 0.8 - 1e-6 } rotate <10, 20, 30> }
#break
#case (2) // a lamp in a ball with a wall of 1e-9; 0
  Lamp(<0.1, 0.2, -0.1>, 50)
  difference { sphere { 0, 0.8 } sphere { 0, 0.8 - 1e-9 } }
#break
#case (3) // a lamp in a room of six walls that touch at their edges; 0
  Lamp(<0.1, 0.2, -0.1>, 50)
  union {
    box { -0.8, <0.8, 0.8, -0.7> } box { <-0.8, -0.8, 0.7>, 0.8 }
    box { <-0.8, -0.8, -0.7>, <-0.7, 0.8, 0.7> } box { <0.7, -0.8, -0.7>, <0.8, 0.8, 0.7> }
    box { <-0.7, -0.8, -0.7>, <0.7, -0.7, 0.7> } box { <-0.7, 0.7, -0.7>, <0.7, 0.8, 0.7> }
    rotate <10, 20, 30>
  }
#break
#case (4) // a lamp in a ball of 3480 triangles; 0
  Lamp(<0.1, 0.2, -0.1>, 50)
  mesh {
    #declare I = 0;
    #while (I < Rows)
      #declare J = 0;
      #while (J < Columns)
        #if (I > 0) triangle { Corner(I, J), Corner(I + 1, J), Corner(I, J + 1) } #end
        #if (I < Rows - 1) triangle { Corner(I + 1, J), Corner(I + 1, J + 1), Corner(I, J + 1) } #end
        #declare J = J + 1;
      #end
      #declare I = I + 1;
    #end
  }
#break
#case (5) // a lamp under a height_field, in a box without a lid that it closes; 0
  Lamp(<0.1, -0.7, -0.1>, 50)
  height_field { function 50, 50 { 0.5 + 0.4*sin(20*x)*cos(17*y) } scale <1.6, 0.5, 1.6> translate <-0.8, -0.3, -0.8> }
  difference { box { <-0.8, -1.1, -0.8>, <0.8, 0.3, 0.8> } box { <-0.8, -2, -0.8>, <0.8, 1, 0.8> scale <1 - 1e-3, 1, 1 - 1e-3> } }
#break
#case (6) // a lamp behind two walls that meet in a line; 0
  Lamp(<0.3, 0.5, 6>, 50)
  box { <-50, -1.1, 3>, <0.3, 50, 3.01> }
  box { <0.3, -1.1, 3>, <50, 50, 3.01> }
#break
#case (7) // the other side of a wall of 1e-6 in a caustic; 0
  Lamp(<0.1, 0.3, 9>, 1)
  box { <-50, -50, 1.5>, <50, 50, 1.5 + 1e-6> }
  sphere { <0, 0.1, 3>, 0.8 pigment { rgbt 1 } finish { ambient 0 diffuse 0 } interior { ior 1.5 } photons { target refraction on } }
#break
#case (8) // photons with nothing to hit; 0
  #if (!Sound) sphere { <0, 0, 90>, 0.01 pigment { rgbt 1 } finish { diffuse 0 } interior { ior 1.5 } photons { target refraction on reflection on } } #end
#break
#end
