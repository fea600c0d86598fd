// A room with one window: a patch of sun on the floor, the sky outside, and what walls and floor send
// on.  Its indirect light, at equal error, is what equal_error.pl times.  Count, Bound and Bounces
// may be declared from outside.  SPDX-License-Identifier: Apache-2.0
#version 3.7;
#ifndef (Count) #declare Count = 100; #end
#ifndef (Bound) #declare Bound = 0.5; #end
#ifndef (Bounces) #declare Bounces = 3; #end

global_settings {
  assumed_gamma 1
  max_trace_level 10
#ifdef (pms_version)
  pms { gi on }
#else
  radiosity { count Count error_bound Bound recursion_limit Bounces pretrace_start 0.08 pretrace_end 0.01 }
#end
}

camera { location <1.7, 1.3, -1.8> look_at <-0.3, 0.9, 0.8> angle 68 right x * image_width / image_height }

light_source {
  <-30, 28, 21>, rgb <6, 5.5, 4.6>
  spotlight point_at <-2, 1.3, 0> radius 2.5 falloff 2.7
}
sky_sphere { pigment { rgb <1.3, 1.6, 2> } }

#default { finish { ambient 0 diffuse 1 } }
#declare White = pigment { rgb <0.72, 0.7, 0.66> };
box { <-2.1, -0.1, -2.1>, <2.1, 0, 2.1> pigment { rgb <0.5, 0.36, 0.24> } }
box { <-2.1, 2.4, -2.1>, <2.1, 2.5, 2.1> pigment { White } }
box { <-2.1, -0.1, 2>, <2.1, 2.5, 2.1> pigment { White } }
box { <-2.1, -0.1, -2.1>, <2.1, 2.5, -2> pigment { White } }
box { <2, -0.1, -2.1>, <2.1, 2.5, 2.1> pigment { rgb <0.25, 0.4, 0.5> } }
difference {
  box { <-2.2, -0.1, -2.1>, <-2, 2.5, 2.1> }
  box { <-3, 0.7, -0.9>, <-1, 2.1, 0.9> }
  pigment { White }
}
box { <-0.9, 0, 0.9>, <0.1, 0.75, 1.7> pigment { rgb <0.6, 0.2, 0.12> } }
sphere { <-0.4, 1.0, 1.3>, 0.25 pigment { rgb 0.75 } }
cylinder { <0.9, 0, 0.9>, <0.9, 1.1, 0.9>, 0.22 pigment { rgb <0.3, 0.5, 0.25> } }
