// A slab of coloured glass.
// caustic: the picture is the receiver
#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 10 photons { count 200000 } }
camera { orthographic location <0, .5, 0> direction -y right 6.4 * x up 4.8 * z }
plane { y, 0 pigment { rgb .35 } finish { ambient 0 diffuse 1 } }
light_source { <5, 30, -8>, .4 photons { refraction on reflection off } }
box { <-2.4, 1, -1>, <-.4, 1.6, 1> photons { target reflection off refraction on } pigment { rgbf <.9, .5, .3, 1> } finish { ambient 0 diffuse 0 } interior { ior 1.5 } }

