// Things that are very thin, flat, sharp or large; or (Sound) not quite so, or described without.
// SPDX-License-Identifier: Apache-2.0
#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 10 }
#include "stage.inc"
Stage()
#declare Wall = (Sound ? 1e-4 : 1e-6);
// no reflection: it would show the far checkers
#declare Plain = material { texture { pigment { rgbt 0.9 } finish { ambient 0 diffuse 0.2 } } interior { ior 1.5 } }
#macro Shell (Outer, Inner) difference { object { Outer } object { Inner } rotate <20, 30, 0> } #end
#macro Cut (Body)
  difference {
    object { Body pigment { rgb <0.9, 0.5, 0.3> } }
    box { <0, 0, -3>, 3 pigment { rgb <0.3, 0.9, 0.3> } }
    finish { ambient 0.1 diffuse 0.8 }
    rotate <10, 20, 0>
  }
#end
#declare Ball_Shell = Shell(sphere { 0, 0.9 }, sphere { 0, 0.9 - Wall })
#declare Box_Shell = Shell(box { -0.8, 0.8 }, box { -0.8 + Wall, 0.8 - Wall })
#declare Pipe = Shell(cylinder { -0.9*y, 0.9*y, 0.6 }, cylinder { -y, y, 0.6 - Wall })
#declare Ring_Shell = Shell(torus { 0.6, 0.3 }, torus { 0.6, 0.3 - Wall })
#macro Lens (R) intersection { sphere { (R - 0.5/R)*x, R } sphere { (0.5/R - R)*x, R } rotate <0, 60, 20> } #end
#macro Super (E, N) superellipsoid { <E, N> scale 0.8 rotate <20, 30, 0> } #end

#switch (Case)
#case (1) // a ball shell of glass with a wall of 1e-6; 150
  object { Ball_Shell material { Glass } }
#break
#case (2) // a ball shell with a wall of 1e-6 cut open; 8
  Cut(Ball_Shell)
#break
#case (3) // a box shell of glass with a wall of 1e-6; 150
  object { Box_Shell material { Glass } }
#break
#case (4) // a box shell with a wall of 1e-6 cut open; 8
  Cut(Box_Shell)
#break
#case (5) // a pipe of glass with a wall of 1e-6; 150
  object { Pipe material { Glass } }
#break
#case (6) // a hollow ring of glass with a wall of 1e-6; 250
  object { Ring_Shell material { Glass } }
#break
#case (7) // a ball shell of glass with a wall of 1 %, made in two ways; 2
  #if (Sound)
    intersection { sphere { 0, 0.9 } sphere { 0, 0.891 inverse } material { Glass } }
  #else
    difference { sphere { 0, 0.9 } sphere { 0, 0.891 } material { Glass } }
  #end
#break
#case (8) // a lens cut from two balls of radius 1e5; 20
  object { Lens((Sound ? 1e4 : 1e5)) material { Plain } }
#break
#case (9) // an opaque lens cut from two balls of radius 1e5; 20
  object { Lens((Sound ? 1e4 : 1e5)) material { Solid } }
#break
#case (10) // a lens cut from two balls of radius 1e6, its rim as thin as numbers are coarse; 400
  object { Lens((Sound ? 1e4 : 1e6)) material { Plain } }
#break
#case (11) // a square of 3000 needle triangles; 2
  #if (Sound)
    polygon { 5, <-0.8, -0.8>, <0.8, -0.8>, <0.8, 0.8>, <-0.8, 0.8>, <-0.8, -0.8> rotate <30, 20, 0> material { Solid } }
  #else
    mesh {
      #declare I = 0;
      #while (I < 1500)
        #declare A = -0.8 + 1.6*I/1500; #declare B = -0.8 + 1.6*(I + 1)/1500;
        triangle { <-0.8, A, 0>, <0.8, A, 0>, <-0.8, B, 0> }
        triangle { <0.8, A, 0>, <0.8, B, 0>, <-0.8, B, 0> }
        #declare I = I + 1;
      #end
      rotate <30, 20, 0> material { Solid }
    }
  #end
#break
#case (12) // a disc of 4096 needle triangles around a point; 4
  #if (Sound)
    disc { 0, z, 0.8 rotate <30, 20, 0> material { Solid } }
  #else
    mesh {
      #declare I = 0;
      #while (I < 4096)
        triangle { 0, vrotate(0.8*x, z*360*I/4096), vrotate(0.8*x, z*360*(I + 1)/4096) }
        #declare I = I + 1;
      #end
      rotate <30, 20, 0> material { Solid }
    }
  #end
#break
#case (13) // a superellipsoid of exponents 1e-3 is a box; 60
  #if (Sound) box { -0.8, 0.8 rotate <20, 30, 0> material { Solid } } #else object { Super(1e-3, 1e-3) material { Solid } } #end
#break
#case (14) // a superellipsoid of exponents 1 and 1e-3 is a cylinder; 60
  #if (Sound) cylinder { -0.8*z, 0.8*z, 0.8 rotate <20, 30, 0> material { Solid } } #else object { Super(1, 1e-3) material { Solid } } #end
#break
#case (15) // a superellipsoid of exponents 1 is a ball, in glass; 2
  #if (Sound) sphere { 0, 0.8 material { Glass } } #else object { Super(1, 1) material { Glass } } #end
#break
#case (16) // a cone that narrows by 1e-9 is a cylinder, in glass; 2
  #if (Sound) cylinder { -0.8*y, 0.8*y, 0.6 rotate <20, 0, 30> material { Glass } }
  #else cone { -0.8*y, 0.6, 0.8*y, 0.6 - 1e-9 rotate <20, 0, 30> material { Glass } } #end
#break
#case (17) // a piece of a torus of radius 1e7 is a cylinder; 2
  intersection {
    #if (Sound) cylinder { -2*z, 2*z, 0.4 } #else torus { 1e7, 0.4 translate 1e7*x } #end
    box { -0.9, 0.9 }
    rotate <10, 50, 0> material { Solid }
  }
#break
#case (18) // a piece of a torus of radius 1e7 is a cylinder, in glass; 2
  intersection {
    #if (Sound) cylinder { -2*z, 2*z, 0.4 } #else torus { 1e7, 0.4 translate 1e7*x } #end
    box { -0.9, 0.9 }
    rotate <10, 50, 0> material { Glass }
  }
#break
#case (19) // a ball on a ground that is a ball of radius 1e8; 2
  sphere { -0.1*y, 0.6 material { Solid } }
  #if (Sound) plane { y, -0.7 material { Solid } } #else sphere { (-1e8 - 0.7)*y, 1e8 material { Solid } } #end
#break
#case (20) // a box without thickness; 8
  box { <-0.8, 0, -0.8>, <0.8, (Sound ? 1e-4 : 0), 0.8> rotate <20, 30, 20> material { Solid } }
#break
#case (21) // a sheet of glass 1e-9 thick; 8
  box { <-0.8, 0, -0.8>, <0.8, (Sound ? 1e-4 : 1e-9), 0.8> rotate <20, 30, 20> material { Glass } }
#break
#case (22) // a cylinder 1e-6 thick on edge casts no shadow and is not seen; 0
  #if (!Sound) cylinder { 0, 1e-6*vnormalize(<0.3, 0.2, 1>), 1e-7 material { Solid } } #end
#break
#case (23) // a hundred shells of glass inside each other, all of ior 1; 2
  #if (!Sound)
    #declare I = 0;
    #while (I < 50)
      difference { sphere { 0, 0.9 - I*0.001 } sphere { 0, 0.8995 - I*0.001 } pigment { rgbt 1 } finish { ambient 0 diffuse 0 } interior { ior 1 } }
      #declare I = I + 1;
    #end
  #end
#break
#end
