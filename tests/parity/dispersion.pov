// Dispersion: bands of colour through a ball, a half ball and a plate; once below 1.
#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 12 }
camera { location <0, 1.2, -6> look_at <0, .3, 0> angle 50 }
light_source { <3, 6, -4>, 1 }
plane { y, -1 pigment { checker rgb .9 rgb .1 } finish { ambient .1 diffuse .8 } }
box { <-4, -1, 3>, <4, 3, 3.1> finish { ambient 1 diffuse 0 }
  pigment { gradient x color_map { [0 rgb 0] [.5 rgb 0] [.5 rgb 1] [1 rgb 1] } scale .4 } }
#declare Glass = texture { pigment { rgbt 1 }
  finish { ambient 0 diffuse 0 reflection { 0, 1 fresnel } conserve_energy } }
sphere { <-1.6, 0, 0>, .9 texture { Glass } interior { ior 1.5 dispersion 1.1 dispersion_samples 12 } }
difference { sphere { <.4, 0, 0>, .9 } plane { -z, -.2 } texture { Glass }
  interior { ior 1.6 dispersion .92 } }
box { -.5, .5 scale <1, 1.6, .5> rotate <0, 40, 0> translate <2, -.1, 0> texture { Glass }
  interior { ior 1 dispersion 1.2 dispersion_samples 3 } }
