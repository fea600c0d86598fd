// Patterns in uv: of pigments, textures and objects, under transforms, in lists and layers.
// SPDX-License-Identifier: Apache-2.0
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 4, -12> look_at 0 angle 40 }
light_source { <6, 12, -10>, 1 }
#declare C = pigment { checker rgb 1 rgb <0.8, 0.2, 0.1> scale 1/8 }
#declare T = texture { uv_mapping pigment { C } }
plane { y, -3 pigment { rgb 0.5 } }
sphere { 0, 0.5 uv_mapping pigment { C } scale 2 rotate 30*z translate <-3, 1.5, 0> }
box { -0.8, 0.8 texture { T } rotate <20, 30, 0> translate <0, 1.5, 0> }
torus { 0.8, 0.35 pigment { uv_mapping C } rotate 40*x translate <3, 1.5, 0> }
sor { 6, <.1, -1.2>, <.6, -1>, <.9, -.2>, <.5, .6>, <.4, .9>, <.3, 1.2> texture { T }
  translate <-3, -1.5, 0> }
difference { sphere { 0, 1 } sphere { -z, 0.7 texture { T } }
  uv_mapping pigment { gradient y color_map { [0 rgb y] [1 rgb z] } scale 0.2 }
  rotate 20*x translate <0, -1.5, 0> }
mesh { triangle { <-1, -1, 0>, <1, -1, 0>, <1, 1, 0> uv_vectors <0, 0>, <1, 0>, <1, 1> }
  triangle { <-1, -1, 0>, <1, 1, 0>, <-1, 1, 0> uv_vectors <0, 0>, <1, 1>, <0, 1> }
  pigment { uv_mapping checker pigment { gradient x scale 0.3 } pigment { rgb x } scale 0.25 }
  translate <3, -1.5, 0> }
