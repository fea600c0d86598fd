// The caustics of a ball and of a ring of glass; or (Sound) of the same at its common size and place.
// SPDX-License-Identifier: Apache-2.0
#version 3.7;
#ifndef (Case) #declare Case = 1; #end
#ifndef (Sound) #declare Sound = 0; #end
#declare Scale = 1; #declare Turn = 0; #declare Away = 0; #declare Ring = 0;
#macro Moved (S, T, A) #if (!Sound) #declare Scale = S; #declare Turn = T; #declare Away = A; #end #end
#switch (Case)
#case (1) // the caustic of a ball scaled by 2^-20; 0
  Moved(pow(2, -20), 0, 0)
#break
#case (2) // the caustic of a ball scaled by 2^20; 0
  Moved(pow(2, 20), 0, 0)
#break
#case (3) // the caustic of a ring scaled by 2^-13; 0
  Moved(pow(2, -13), 0, 0) #declare Ring = 1;
#break
#case (4) // the caustic of a ring scaled by 2^13; 0
  Moved(pow(2, 13), 0, 0) #declare Ring = 1;
#break
#case (5) // the caustic of a ball scaled by 1e-4, in blocks; 0 blocks
  Moved(1e-4, 0, 0)
#break
#case (6) // the caustic of a ball scaled by 1e4, in blocks; 0 blocks
  Moved(1e4, 0, 0)
#break
#case (7) // the caustic of a ring scaled by 1e-4, in blocks; 0 blocks
  Moved(1e-4, 0, 0) #declare Ring = 1;
#break
#case (8) // the caustic of a ring scaled by 1e4, in blocks; 0 blocks
  Moved(1e4, 0, 0) #declare Ring = 1;
#break
#case (9) // the caustic of a ball turned, in blocks; 0 blocks
  Moved(1, 37.3, 0)
#break
#case (10) // the caustic of a ring turned, in blocks; 0 blocks
  Moved(1, 37.3, 0) #declare Ring = 1;
#break
#case (11) // the caustic of a ball shifted by 1e3, in blocks; 0 blocks
  Moved(1, 0, 1e3)
#break
#case (12) // the caustic of a ball shifted by 1e6, in blocks; 0 blocks
  Moved(1, 0, 1e6)
#break
#end
#declare Turns = <Turn, 0.7*Turn, 1.9*Turn>;
#declare Shift = Away*<0.6, -0.48, 0.64>;
#declare Place = transform { scale Scale rotate Turns translate Shift }
#macro Put (P) (vrotate(P*Scale, Turns) + Shift) #end
global_settings { assumed_gamma 1 max_trace_level 8 photons { spacing 0.012*Scale } }
camera { location Put(<1.13, 2.71, -3.97>) sky vrotate(y, Turns) right x*4/3 angle 38 look_at Put(<0.3, -0.7, 0.2>) }
light_source { Put(<-3.1, 6.3, -4.2>), rgb 1 }
plane { y, -1 pigment { rgb 0.7 } finish { ambient 0 diffuse 0.7 } transform Place }
object {
  #if (Ring) torus { 0.6, 0.25 rotate <30, 0, 20> translate -0.2*y } #else sphere { 0, 0.8 } #end
  pigment { rgbt 1 } finish { ambient 0 diffuse 0 } interior { ior 1.5 }
  photons { target refraction on reflection off }
  transform Place
}
