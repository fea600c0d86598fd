// Media in boxes: absorption, emission and both, seen before a checker.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 2, -8> look_at <0, 1, 0> angle 45 }
 light_source { <3, 8, -6>, 1 }
plane { z, 4 pigment { checker rgb 1 rgb <.2, .4, .6> } finish { ambient .6 diffuse .4 } }
box { <-3, 0, -1>, <-1.2, 2.5, 1> hollow pigment { rgbt 1 } interior { media { absorption <.2, .5, 1> } } }
box { <-.9, 0, -1>, <.9, 2.5, 1> hollow pigment { rgbt 1 } interior { media { emission <.2, .3, .1> } } }
box { <1.2, 0, -1>, <3, 2.5, 1> hollow pigment { rgbt 1 } interior { media { emission <.3, .2, .1> absorption .1 } media { absorption <0, .3, 0> } } }
