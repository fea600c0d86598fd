// The five scattering types, lit by one lamp, with the shadows they cast.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 2, -8> look_at <0, 1, 0> angle 45 }
 light_source { <2, 9, -3>, 1.5 }
plane { y, 0 pigment { checker rgb .9 rgb .4 } }

#declare I = 0;
#while (I < 5)
  sphere { <-3.4 + I * 1.7, 1, 0>, .8 hollow pigment { rgbt 1 } interior { media { scattering { I + 1, <.3, .4, .5> #if (I = 4) eccentricity .4 #end } samples 60 } } }
  #declare I = I + 1;
#end
