// Point, spot, cylinder and parallel lights, fading.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 6, -10> look_at <0, 0, 0> angle 55 }
plane { y, 0 pigment { rgb .8 } finish { ambient 0 } }
union {
  sphere { <-4, .7, 0>, .7 } sphere { <-1.3, .7, 0>, .7 } sphere { <1.3, .7, 0>, .7 } sphere { <4, .7, 0>, .7 }
  pigment { rgb <.8, .8, .7> } finish { ambient .02 }
}
light_source { <-4.5, 4, -2>, <.9, .3, .2> spotlight point_at <-4, 0, 0> radius 12 falloff 25 tightness 3 }
light_source { <-1.3, 4, -1>, <.3, .8, .3> cylinder point_at <-1.3, 0, 0> radius .6 falloff 1.2 }
light_source { <1.3, 3, -2>, <.4, .5, 1.5> fade_distance 2 fade_power 2 }
light_source { <6, 8, -6>, .25 parallel point_at <4, 0, 0> }
light_source { <0, 10, -10>, .1 shadowless }
