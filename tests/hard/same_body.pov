// Bodies described in an unlikely way; or (Sound) as anyone would.
// SPDX-License-Identifier: Apache-2.0
#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 10 }
#include "stage.inc"
Stage()
#declare Turn = transform { rotate <20, 30, 10> }
#declare Capsule = merge { cylinder { -0.5*x, 0.5*x, 0.4 } sphere { -0.5*x, 0.4 } sphere { 0.5*x, 0.4 } transform Turn }
#declare Frustum = cone { -0.7*y, 0.8, 0.7*y, 0.3 transform Turn }
#declare Ball = sphere { 0, 0.8 }
#declare Bowl = difference { object { Ball } sphere { <0.2, 0.5, -0.4>, 0.6 } }

#switch (Case)
#case (1) // a linear sphere_sweep is a cylinder with round ends, in glass; 2
  #if (Sound) object { Capsule material { Glass } }
  #else sphere_sweep { linear_spline 2, -0.5*x, 0.4, 0.5*x, 0.4 transform Turn material { Glass } } #end
#break
#case (2) // a b_spline sphere_sweep through points in a line; 2
  #if (Sound) object { Capsule material { Solid } }
  #else sphere_sweep { b_spline 6, -(0.5 + 1/3)*x, 0.4, -0.5*x, 0.4, -0.5/3*x, 0.4, 0.5/3*x, 0.4, 0.5*x, 0.4, (0.5 + 1/3)*x, 0.4 transform Turn material { Solid } } #end
#break
#case (3) // a cubic sphere_sweep through points in a line, in glass; 2
  #if (Sound) object { Capsule material { Glass } }
  #else sphere_sweep { cubic_spline 4, -1.5*x, 0.4, -0.5*x, 0.4, 0.5*x, 0.4, 1.5*x, 0.4 transform Turn material { Glass } } #end
#break
#case (4) // a sphere_sweep cut out of a box; 2
  difference {
    box { <-0.7, -0.5, -0.6>, <0.7, 0.35, 0.6> }
    #if (Sound) cylinder { <-0.4, 0.35, 0>, <0.4, 0.35, 0>, 0.3 } sphere { <-0.4, 0.35, 0>, 0.3 } sphere { <0.4, 0.35, 0>, 0.3 }
    #else sphere_sweep { linear_spline 3, <-0.4, 0.35, 0>, 0.3, <0.1, 0.35, 0>, 0.3, <0.4, 0.35, 0>, 0.3 } #end
    transform Turn material { Solid }
  }
#break
#case (5) // a linear lathe is a cone, in glass; 2
  #if (Sound) object { Frustum material { Glass } }
  #else lathe { linear_spline 5, <0, -0.7>, <0.8, -0.7>, <0.3, 0.7>, <0, 0.7>, <0, -0.7> transform Turn material { Glass } } #end
#break
#case (6) // a bezier lathe of straight lines is a cone, in glass; 2
  #if (Sound) object { Frustum material { Glass } }
  #else
    lathe {
      bezier_spline 12,
      <0, -0.7>, <0.2, -0.7>, <0.5, -0.7>, <0.8, -0.7>, <0.8, -0.7>, <0.7, -0.42>, <0.4, 0.42>, <0.3, 0.7>,
      <0.3, 0.7>, <0.2, 0.7>, <0.1, 0.7>, <0, 0.7>
      transform Turn material { Glass }
    }
  #end
#break
#case (7) // a sor with equal radii is a cylinder, in glass; 2
  #if (Sound) cylinder { -0.7*y, 0.7*y, 0.5 transform Turn material { Glass } }
  #else sor { 5, <0.5, -1>, <0.5, -0.7>, <0.5, 0.1>, <0.5, 0.7>, <0.5, 1> transform Turn material { Glass } } #end
#break
#case (8) // a prism over a square is a box, in glass; 2
  #if (Sound) box { -0.7, 0.7 transform Turn material { Glass } }
  #else prism { -0.7, 0.7, 5 <-0.7, -0.7>, <0.7, -0.7>, <0.7, 0.7>, <-0.7, 0.7>, <-0.7, -0.7> transform Turn material { Glass } } #end
#break
#case (9) // a quadric is a ball, in glass; 2
  #if (Sound) object { Ball material { Glass } } #else quadric { <1, 1, 1>, 0, 0, -0.64 material { Glass } } #end
#break
#case (10) // a quartic is a torus, in glass; 2
  #if (Sound) torus { 0.5, 0.3 transform Turn material { Glass } }
  #else
    #declare K = 0.25 - 0.09; #declare L = -0.25 - 0.09;
    quartic {
      <1, 0, 0, 0, 2, 0, 0, 2, 0, 2*L, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 2, 0, 2*K, 0, 0, 0, 0, 1, 0, 2*L, 0, K*K>
      transform Turn material { Glass }
    }
  #end
#break
#case (11) // an isosurface is a ball, in glass; 2
  #if (Sound) object { Ball material { Glass } }
  #else isosurface { function { x*x + y*y + z*z - 0.64 } contained_by { box { -0.9, 0.9 } } max_gradient 4 accuracy 1e-7 material { Glass } } #end
#break
#case (12) // an isosurface with a ball cut out; 2
  difference {
    #if (Sound) object { Ball } #else isosurface { function { x*x + y*y + z*z - 0.64 } contained_by { box { -0.9, 0.9 } } max_gradient 4 accuracy 1e-7 all_intersections } #end
    sphere { <0.2, 0.5, -0.4>, 0.6 } material { Solid }
  }
#break
#case (13) // an isosurface cut out of a ball; 2
  difference {
    object { Ball }
    #if (Sound) sphere { <0.2, 0.5, -0.4>, 0.6 }
    #else isosurface { function { x*x + y*y + z*z - 0.36 } contained_by { box { -0.7, 0.7 } } max_gradient 4 accuracy 1e-7 all_intersections translate <0.2, 0.5, -0.4> } #end
    material { Solid }
  }
#break
#case (14) // a blob of one component is a ball, in glass; 2
  #if (Sound) sphere { 0, sqrt(0.5) material { Glass } } #else blob { threshold 0.25 sphere { 0, 1, 1 } material { Glass } } #end
#break
#case (15) // a julia_fractal around 0 is a ball; 20
  #if (Sound) sphere { 0, 1 scale 0.8 material { Solid } }
  #else julia_fractal { <0, 0, 0, 0> quaternion sqr max_iteration 24 precision 10000 scale 0.8 material { Solid } } #end
#break
#case (16) // a mesh of four triangles is cut by planes, in glass; 2
  #declare P = <-0.8, -0.7, -0.6>; #declare Q = <0.9, -0.6, -0.5>; #declare R = <0, -0.8, 0.9>; #declare S = <0.05, 0.9, 0.1>;
  #macro Face (A, B, C) #local N = vnormalize(vcross(B - A, C - A)); plane { N, vdot(N, A) } #end
  #if (Sound) intersection { Face(P, Q, R) Face(P, S, Q) Face(Q, S, R) Face(R, S, P) material { Glass } }
  #else mesh { triangle { P, Q, R } triangle { P, Q, S } triangle { Q, R, S } triangle { R, P, S } inside_vector <0.2, 1, 0.3> material { Glass } } #end
#break
#case (17) // a flat bicubic_patch is a polygon; 2
  #if (Sound) polygon { 5, <-0.75, -0.75>, <0.75, -0.75>, <0.75, 0.75>, <-0.75, 0.75>, <-0.75, -0.75> transform Turn material { Solid } }
  #else
    bicubic_patch {
      type 1 flatness 0 u_steps 3 v_steps 3
      #declare I = 0;
      #while (I < 16) #if (I > 0) , #end <mod(I, 4)*0.5 - 0.75, int(I/4)*0.5 - 0.75, 0> #declare I = I + 1; #end
      transform Turn material { Solid }
    }
  #end
#break
#case (18) // a bicubic_patch with an edge that is a point is a triangle; 2
  #if (Sound) triangle { <-0.75, -0.75, 0>, <0.75, -0.75, 0>, <0, 0.75, 0> transform Turn material { Solid } }
  #else
    bicubic_patch {
      type 1 flatness 0 u_steps 3 v_steps 3
      #declare I = 0;
      #while (I < 16) #if (I > 0) , #end <(mod(I, 4)*0.5 - 0.75)*(1 - int(I/4)/3), int(I/4)*0.5 - 0.75, 0> #declare I = I + 1; #end
      transform Turn material { Solid }
    }
  #end
#break
#case (19) // a height_field that rises evenly is a polygon; 2
  #if (Sound) polygon { 5, <-0.7, -0.5, -0.7>, <0.7, 0.5, -0.7>, <0.7, 0.5, 0.7>, <-0.7, -0.5, 0.7>, <-0.7, -0.5, -0.7> transform Turn material { Solid } }
  #else height_field { function 40, 40 { x } translate <-0.5, 0, -0.5> scale <1.4, 1, 1.4> translate -0.5*y transform Turn material { Solid } } #end
#break
#case (20) // a paraboloid in a cylinder that reaches past its tip; 2
  intersection {
    quadric { <1, 0, 1>, 0, <0, -1, 0>, 0 }
    cylinder { (Sound ? -0.1 : -1e5)*y, 0.8*y, 2 }
    translate -0.4*y transform Turn material { Solid }
  }
#break
#case (21) // a bowl as a mirror image of itself; 2
  #if (Sound) object { Bowl material { Glass } } #else object { Bowl scale <-1, 1, 1> scale <-1, 1, 1> material { Glass } } #end
#break
#case (22) // a ball flattened a million times and drawn out again, in glass; 2
  #if (Sound) object { Ball material { Glass } } #else object { Ball scale <1e-6, 1, 1> rotate y*90 scale <1, 1, 1e6> material { Glass } } #end
#break
#case (23) // a ball moved away by 1e9 and back, in glass; 8
  #if (Sound) object { Ball material { Glass } } #else object { Ball translate 1e9*x translate -1e9*x material { Glass } } #end
#break
#case (24) // a ball turned a thousand times, in glass; 2
  #if (Sound) object { Bowl material { Glass } }
  #else object { Bowl #declare I = 0; #while (I < 1000) rotate y*36 #declare I = I + 1; #end material { Glass } } #end
#break
#end
