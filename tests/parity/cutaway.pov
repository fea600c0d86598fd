// Cuts that show what they cut.  SPDX-License-Identifier: Apache-2.0
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <4, 5, -9> look_at 0 angle 42 }
light_source { <6, 12, -10>, 1 }
#declare R = pigment { rgb <0.9, 0.2, 0.1> }
#declare G = pigment { checker rgb <0.1, 0.7, 0.2> rgb <0.9, 0.9, 0.3> scale 0.3 }
#declare Notch = box { <-0.6, -0.5, -2>, <0.5, 0.6, 0> }
plane { y, -1.2 pigment { rgb 0.5 } }
difference { sphere { 0, 1 pigment { G } } object { Notch } cutaway_textures
  translate <-2.5, 0, 0> }
difference { union { sphere { -0.3*x, 0.8 pigment { R } } sphere { 0.3*x, 0.8 pigment { G } } }
  object { Notch } cutaway_textures }
intersection { sphere { 0, 1 pigment { R } } box { -0.75, 0.75 } cutaway_textures
  translate <2.5, 0, 0> }
union { difference { sphere { 0, 1 pigment { G } } object { Notch } cutaway_textures }
  pigment { rgb z } translate <0, 0, 3> }
