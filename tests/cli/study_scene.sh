# The scene of the tests of studies, sourced by each: it has a caustic of few photons.

# glass_ball PHOTONS FILE: write it
glass_ball() {
    cat >"$2" <<END
#version 3.7;
global_settings { assumed_gamma 1 photons { count $1 gather 5, 25 } }
camera { location <0,3,-6> look_at <0,0.8,0> angle 40 }
light_source { <-4,7,3>, 1 }
plane { y, 0 pigment { rgb .8 } finish { ambient 0 diffuse 0.9 } }
sphere { <0,1,0>, 1 pigment { rgbt 1 } finish { ambient 0 diffuse 0 }
  interior { ior 1.5 } photons { target refraction on collect off } }
END
}
