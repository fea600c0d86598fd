// Light thrown back inside a ring of metal.
// caustic: the picture is the receiver
#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 10 photons { count 200000 } }
camera { orthographic location <0, 6, 0> direction -y right 6.4 * x up 4.8 * z }
plane { y, 0 pigment { rgb .35 } finish { ambient 0 diffuse 1 } }
light_source { <30, 25, 0>, .4 photons { reflection on refraction off } }
cylinder { -.01 * y, .8 * y, 1.6 open photons { target reflection on refraction off } pigment { rgb 0 } finish { ambient 0 diffuse 0 reflection .9 } }
