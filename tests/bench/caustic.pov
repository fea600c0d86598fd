// A glass ball under a small area light: its caustic, at equal error, is what equal_error.pl times.
// Count and Gather may be declared from outside.  SPDX-License-Identifier: Apache-2.0
#version 3.7;
#ifndef (Count) #declare Count = 100000; #end
#ifndef (Gather) #declare Gather = 80; #end
global_settings { assumed_gamma 1 max_trace_level 12 photons { count Count gather 20, Gather } }
camera { location <0, 4.2, -5.2> angle 40 right x * image_width / image_height look_at <0.3, 0, 0.5> }
light_source {
  <-4, 7, -1>, rgb <1.1, 1.05, 1>
  area_light <0.5, 0, 0>, <0, 0.5, 0>, 4, 4 adaptive 1 jitter circular orient
  photons { reflection on refraction on area_light }
}
plane { y, 0 pigment { rgb <0.75, 0.73, 0.7> } finish { ambient 0 diffuse 0.9 } photons { collect on } }
sphere {
  <0, 1, 0>, 1
  pigment { rgbt <1, 1, 1, 1> }
  finish { ambient 0 diffuse 0 specular 0.6 roughness 0.005 reflection { 0, 1 fresnel on } conserve_energy }
  interior { ior 1.5 }
  photons { target reflection on refraction on collect off }
}
