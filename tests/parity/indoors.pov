// A room of many small objects made by macros and loops.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 2.4, -5.5> look_at <0, 1.2, 0> angle 62 }
light_source { <0, 3.8, -1>, .9 fade_distance 4 fade_power 1 }
box { <-4, 0, -8>, <4, 4, 4> hollow pigment { rgb <.8, .78, .7> } }
#macro Shelf(H, Count)
  box { <-3, H, 3.2>, <3, H + .1, 4> pigment { rgb <.5, .35, .2> } }
  #local I = 0;
  #while (I < Count)
    #switch (mod(I, 3))
      #case (0) cylinder { <-2.7 + I * .55, H + .1, 3.6>, <-2.7 + I * .55, H + .5, 3.6>, .18 pigment { rgb <.3, .5, .7> } } #break
      #case (1) sphere { <-2.7 + I * .55, H + .3, 3.6>, .2 pigment { rgb <.8, .4, .3> } } #break
      #else box { <-2.85 + I * .55, H + .1, 3.45>, <-2.55 + I * .55, H + .55, 3.75> pigment { rgb <.4, .7, .4> } }
    #end
    #local I = I + 1;
  #end
#end
Shelf(.6, 11) Shelf(1.5, 10) Shelf(2.4, 11)
