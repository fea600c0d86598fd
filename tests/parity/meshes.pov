// Triangles: single, smooth, mesh and mesh2 with normals.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 3, -7> look_at <0, .6, 0> angle 48 }
light_source { <4, 8, -6>, 1 }
plane { y, -.5 pigment { rgb .6 } }
mesh {
  triangle { <-3, 0, 0>, <-2, 0, -1>, <-2.3, 1.6, 0> } triangle { <-2, 0, -1>, <-1.4, 0, .4>, <-2.3, 1.6, 0> }
  triangle { <-1.4, 0, .4>, <-3, 0, 0>, <-2.3, 1.6, 0> } triangle { <-3, 0, 0>, <-1.4, 0, .4>, <-2, 0, -1> }
  pigment { rgb <.9, .4, .3> }
}
smooth_triangle { <-.9, 0, 0>, <-1, .5, -1>, <.9, 0, 0>, <1, .5, -1>, <0, 1.8, .2>, <0, 1, -.4> pigment { rgb <.4, .7, .9> } finish { phong .6 } }
#declare N = 12;
mesh2 {
  vertex_vectors { N + 2, <0, 1.5, 0>, <0, 0, 0> #local I = 0; #while (I < N) , <cos(2 * pi * I / N), .6, sin(2 * pi * I / N)> #local I = I + 1; #end }
  normal_vectors { N + 2, y, -y #local I = 0; #while (I < N) , <cos(2 * pi * I / N), .2, sin(2 * pi * I / N)> #local I = I + 1; #end }
  face_indices { 2 * N #local I = 0; #while (I < N) , <0, 2 + I, 2 + mod(I + 1, N)>, <1, 2 + I, 2 + mod(I + 1, N)> #local I = I + 1; #end }
  pigment { rgb <.6, .9, .4> } finish { specular .4 } translate 2.2 * x
}
