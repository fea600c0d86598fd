// Light that has to find its way; or (Sound) finds it at once.
// SPDX-License-Identifier: Apache-2.0
#version 3.7;
#include "stage.inc"
global_settings { assumed_gamma 1 max_trace_level 60 adc_bailout 1e-5 }
#declare Clear = material { texture { pigment { rgbt 1 } finish { ambient 0 diffuse 0 } } interior { ior 1 } }
#macro Camera_In (P) camera { location P right x*4/3 angle 38 look_at <0, -0.15, 0.1> } #end
#declare Eye = <1.13, 1.71, -3.97>;
#declare Lamp = light_source { <-3.1, 6.3, -4.2>, rgb 1 }

#switch (Case)
#case (1) // the eye in a ball of clear glass, beside its wall by 1e-7; 2
  Camera_In(Eye) light_source { Lamp } object { Floor } sphere { 0, 0.7 material { Solid } }
  #if (!Sound) sphere { 0, vlength(Eye) + 1e-7 material { Clear } } #end
#break
#case (2) // the eye on the wall of a ball of clear glass; 2
  Camera_In(Eye) light_source { Lamp } object { Floor } sphere { 0, 0.7 material { Solid } }
  #if (!Sound) sphere { 0, vlength(Eye) material { Clear } } #end
#break
#case (3) // a lamp in a ball of clear glass, beside its wall by 1e-7; 2
  Camera_In(Eye) light_source { <-1.1, 1.3, -0.2>, rgb 1 } object { Floor } sphere { 0, 0.7 material { Solid } }
  #if (!Sound) sphere { 0, vlength(<-1.1, 1.3, -0.2>) + 1e-7 material { Clear } } #end
#break
#case (4) // thirty panes of grey glass a millionth apart; 2
  Camera_In(Eye) light_source { Lamp } object { Floor }
  #if (Sound) polygon { 5, <-0.9, -0.9>, <0.9, -0.9>, <0.9, 0.9>, <-0.9, 0.9>, <-0.9, -0.9> pigment { rgbt pow(0.97, 30) } finish { ambient 0 diffuse 0 } rotate y*20 }
  #else
    #declare I = 0;
    #while (I < 30)
      polygon { 5, <-0.9, -0.9>, <0.9, -0.9>, <0.9, 0.9>, <-0.9, 0.9>, <-0.9, -0.9> pigment { rgbt 0.97 } finish { ambient 0 diffuse 0 } translate I*1e-6*z rotate y*20 }
      #declare I = I + 1;
    #end
  #end
#break
#case (5) // a mirror with an exponent before a negative sky; 0
  Camera_In(Eye) light_source { Lamp } background { rgb (Sound ? 0 : -0.1) }
  sphere { 0, 0.7 pigment { rgb 0 } finish { ambient 0 diffuse 0 reflection { 0.8 } reflection_exponent 2.5 } }
  plane { y, -1.003 pigment { rgb 0.5 } finish { ambient 0 diffuse 1 } }
#break
#case (6) // a ball of glass in even white light; 2
  Camera_In(Eye) background { rgb 0.5 }
  #if (!Sound) sphere { 0, 0.9 pigment { rgbt 1 } finish { ambient 0 diffuse 0 reflection { 0, 1 fresnel } conserve_energy } interior { ior 1.5 } } #end
#break
#case (7) // a clear slab of 1e-7 in a glowing mist; 2
  Camera_In(Eye) light_source { Lamp } object { Floor }
  sphere { 0, 0.95 hollow pigment { rgbt 1 } finish { ambient 0 diffuse 0 } interior { media { emission 0.3 absorption 0.2 } } }
  #if (!Sound) box { <-0.6, -0.6, 0>, <0.6, 0.6, 1e-7> hollow material { Clear } rotate <20, 30, 0> } #end
#break
#case (8) // a cloth of two colours folded almost flat; 2
  Camera_In(Eye) light_source { Lamp } object { Floor }
  mesh {
    triangle { <-0.8, -0.8, 0>, <0.8, -0.8, 0>, <0.8, 0.8, 0> }
    triangle { <-0.8, -0.8, 0>, <0.8, 0.8, 0>, <0.7, -0.7, 1e-5> }
    pigment { rgb x } finish { ambient 1 diffuse 0 }
    interior_texture { pigment { rgb (Sound ? x : y) } finish { ambient 1 diffuse 0 } }
    rotate y*20
  }
#break
#case (9) // a flat pyramid of glass, each side in a hundred triangles; 2
  Camera_In(Eye) light_source { Lamp } object { Floor }
  #declare N = (Sound ? 1 : 10);
  #macro Side (A, B, C)
    #local I = 0;
    #while (I < N)
      #local J = 0;
      #while (J < N - I)
        triangle { A + (B - A)*I/N + (C - A)*J/N, A + (B - A)*(I + 1)/N + (C - A)*J/N, A + (B - A)*I/N + (C - A)*(J + 1)/N }
        #if (J < N - I - 1) triangle { A + (B - A)*(I + 1)/N + (C - A)*J/N, A + (B - A)*(I + 1)/N + (C - A)*(J + 1)/N, A + (B - A)*I/N + (C - A)*(J + 1)/N } #end
        #local J = J + 1;
      #end
      #local I = I + 1;
    #end
  #end
  mesh {
    Side(<-0.9, -0.2, -0.9>, <0.9, -0.2, -0.9>, <0, -0.1, 0>) Side(<0.9, -0.2, -0.9>, <0.9, -0.2, 0.9>, <0, -0.1, 0>)
    Side(<0.9, -0.2, 0.9>, <-0.9, -0.2, 0.9>, <0, -0.1, 0>) Side(<-0.9, -0.2, 0.9>, <-0.9, -0.2, -0.9>, <0, -0.1, 0>)
    Side(<-0.9, -0.2, -0.9>, <0.9, -0.2, -0.9>, <0.9, -0.2, 0.9>) Side(<-0.9, -0.2, -0.9>, <-0.9, -0.2, 0.9>, <0.9, -0.2, 0.9>)
    inside_vector <0.2, 1, 0.3> material { Glass }
  }
#break
#case (10) // a lamp in line with the edge of a wall; 0
  Camera_In(Eye) object { Floor } light_source { <0, 4, 2>, rgb 1 }
  box { <(Sound ? -1 : 0), -1.1, 1>, <0, 1.5, 2> translate (Sound ? 0 : -x) scale <1, 1, 1> pigment { rgb 1 } finish { ambient 0.1 diffuse 0.8 } }
  #if (!Sound) box { <-1, -1.1, 1>, <0, 1.5, 2> pigment { rgb 1 } finish { ambient 0.1 diffuse 0.8 } } #end
#break
#case (11) // the border of light and shadow on a ball of 528 smooth triangles; 60
  Camera_In(Eye) light_source { <7.1, 2.3, 3.2>, rgb 1.5 } light_source { <-6.1, -0.3, 1.2>, rgb <0.5, 1, 2> }
  #declare Rows = 12; #declare Columns = 24;
  #macro Corner (I, J) vrotate(vrotate(0.9*y, x*180*I/Rows), y*360*J/Columns) #end
  mesh {
    #declare I = 0;
    #while (I < Rows)
      #declare J = 0;
      #while (J < Columns)
        #declare A = Corner(I, J); #declare B = Corner(I + 1, J); #declare C = Corner(I + 1, J + 1); #declare D = Corner(I, J + 1);
        #if (I > 0) smooth_triangle { A, A, B, B, D, D } #end
        #if (I < Rows - 1) smooth_triangle { B, B, C, C, D, D } #end
        #declare J = J + 1;
      #end
      #declare I = I + 1;
    #end
    inside_vector <0.2, 1, 0.3>
    pigment { rgb 1 } finish { ambient 0 diffuse 1 }
    #if (Sound) no_shadow #end
  }
#break
#end
