// A spotlight in smoke, with things in its beam: its shafts, at equal error, are what equal_error.pl
// times.  Samples, Variance, Threshold and Level may be declared from outside.
// SPDX-License-Identifier: Apache-2.0
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 2.2, -8> look_at <0, 1.9, 0> angle 48 right x * image_width / image_height }
light_source {
  <-4.5, 6, 1.5>, rgb <8, 7.4, 6.6>
  spotlight point_at <0.6, 0.6, 0> radius 17 falloff 21
}

media {
  scattering { 1, 0.035 extinction 1 }
#ifdef (Samples) samples Samples #end
#ifdef (Intervals) intervals Intervals #end
#ifdef (Variance) variance Variance #end
#ifdef (Threshold) aa_threshold Threshold #end
#ifdef (Level) aa_level Level #end
}

// a dark room
box { <-6, 0, -9>, <6, 8, 5> hollow pigment { rgb <0.32, 0.3, 0.3> } finish { ambient 0 diffuse 0.7 } }

// a lattice, a ball, and posts of several widths
#declare Bar = finish { ambient 0 diffuse 0.8 }
#declare I = -3;
#while (I <= 3)
  cylinder { <I * 0.32, -1.1, 0>, <I * 0.32, 1.1, 0>, 0.05 + 0.012 * mod(I + 3, 3)
    rotate <38, 70, 0> translate <-2.2, 4.1, 0.9> pigment { rgb <0.5, 0.3, 0.18> } finish { Bar } }
  #declare I = I + 1;
#end
sphere { <0.3, 2.1, 0>, 0.55 pigment { rgb <0.7, 0.25, 0.2> } finish { Bar } }
torus { 0.6, 0.11 rotate <70, 20, 0> translate <-1.2, 1.9, -0.6> pigment { rgb <0.7, 0.6, 0.2> } finish { Bar } }
box { <1.5, 0, -0.7>, <1.75, 2.6, -0.45> pigment { rgb <0.25, 0.35, 0.6> } finish { Bar } }
cylinder { <2.4, 0, 0.6>, <2.4, 3.2, 0.6>, 0.06 pigment { rgb 0.5 } finish { Bar } }
