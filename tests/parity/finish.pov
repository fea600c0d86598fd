// Highlights: phong, specular, metallic, brilliance, ambient and emission.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { orthographic location <0, 0, -10> look_at 0 right 8 * x up 6 * y }
light_source { <-6, 8, -9>, 1 }
light_source { <9, 2, -4>, <.3, .3, .5> }
#declare Skin = pigment { rgb <.8, .5, .2> }
sphere { <-3, 2, 0>, .85 pigment { Skin } finish { phong .8 } }
sphere { <-1, 2, 0>, .85 pigment { Skin } finish { phong .9 phong_size 150 } }
sphere { <1, 2, 0>, .85 pigment { Skin } finish { specular .7 } }
sphere { <3, 2, 0>, .85 pigment { Skin } finish { specular .9 roughness .005 } }
sphere { <-3, 0, 0>, .85 pigment { Skin } finish { specular .8 metallic } }
sphere { <-1, 0, 0>, .85 pigment { Skin } finish { phong .8 metallic .5 } }
sphere { <1, 0, 0>, .85 pigment { Skin } finish { diffuse .9 brilliance 3 } }
sphere { <3, 0, 0>, .85 pigment { Skin } finish { diffuse .8 brilliance .5 } }
sphere { <-3, -2, 0>, .85 pigment { Skin } finish { ambient .5 diffuse .2 } }
sphere { <-1, -2, 0>, .85 pigment { Skin } finish { emission <.2, .1, .4> } }
sphere { <1, -2, 0>, .85 pigment { Skin } finish { ambient 0 diffuse albedo .7 } }
sphere { <3, -2, 0>, .85 pigment { Skin } finish { ambient rgb <.1, .3, .1> diffuse .4 } }
