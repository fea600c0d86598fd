// Media in media: a bubble in water in glass, water that reaches into its glass, ice half in water.
// The cup does not mirror: POV-Ray reflects at walls that bend nothing, pms does not.
#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 20 }
camera { location <0, 2.2, -7> look_at <0, .9, 0> angle 42 }
light_source { <5, 9, -7>, 1 }
sky_sphere { pigment { gradient y color_map { [0 rgb <.7, .8, .9>] [1 rgb <.2, .4, .8>] } } }
plane { y, 0 pigment { checker rgb <.9, .9, .8> rgb <.3, .4, .3> scale .7 } }
#declare Bright = texture { pigment { rgbt 1 } finish { ambient 0 diffuse 0 reflection { 0, 1 fresnel } conserve_energy } }
#declare Dull = texture { pigment { rgbt 1 } finish { ambient 0 diffuse 0 } }
sphere { <-1.8, 1, 0>, 1 texture { Bright } interior { ior 1.5 } }
sphere { <-1.8, 1, 0>, .8 texture { Bright } interior { ior 1.33 } }
sphere { <-1.6, 1.1, -.1>, .4 texture { Bright } interior { ior 1 } }
difference { cylinder { <.4, .01, 0>, <.4, 2, 0>, .8 } cylinder { <.4, .15, 0>, <.4, 2.1, 0>, .7 }
  texture { Dull } interior { ior 1.5 } }
cylinder { <.4, .1, 0>, <.4, 1.4, 0>, .75 texture { Dull } interior { ior 1.33 } }
cylinder { <2.2, .01, 0>, <2.2, 1.2, 0>, .7 texture { Dull } interior { ior 1.33 } }
box { -.25, .25 rotate 20 translate <2.2, 1.15, 0> texture { Dull } interior { ior 1.6 } }
