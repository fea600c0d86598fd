// A room with coloured walls lit through its ceiling: its indirect light, at equal error, is what
// equal_error.pl times.  Count, Bound and Bounces may be declared from outside.
// SPDX-License-Identifier: Apache-2.0
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

camera { location <0, 1, -2.9> look_at <0, 1, 0> angle 52 right x * image_width / image_height }

light_source { <0, 1.9, 0.2>, rgb 0.8 area_light <0.4, 0, 0>, <0, 0, 0.4>, 3, 3 adaptive 1 }

#default { finish { ambient 0 diffuse 1 } }
#declare White = pigment { rgb 0.75 };
box { <-1.2, -0.1, -3.2>, <1.2, 0, 1.2> pigment { White } }
box { <-1.2, 2, -3.2>, <1.2, 2.1, 1.2> pigment { White } }
box { <-1.2, -0.1, 1>, <1.2, 2.1, 1.1> pigment { White } }
box { <-1.2, -0.1, -3.1>, <1.2, 2.1, -3> pigment { White } }
box { <-1.1, -0.1, -3.2>, <-1, 2.1, 1.2> pigment { rgb <0.7, 0.12, 0.1> } }
box { <1, -0.1, -3.2>, <1.1, 2.1, 1.2> pigment { rgb <0.12, 0.55, 0.15> } }
box { <-0.3, -0.1, -0.3>, <0.3, 1.1, 0.3> rotate y * 20 translate <-0.4, 0, 0.4> pigment { White } }
sphere { <0.45, 0.35, -0.2>, 0.35 pigment { rgb <0.3, 0.35, 0.7> } }
