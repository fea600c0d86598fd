// Surfaces that coincide; or (Sound) overlap by a thousandth, or are left out.
// SPDX-License-Identifier: Apache-2.0
#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 40 }
#include "stage.inc"
Stage()
#declare Over = Sound*0.001;
#declare Ball = object { sphere { 0, 0.9 } }
#declare Drilled = difference { box { -0.8, 0.8 } cylinder { -(0.8 + Over)*y, (0.8 + Over)*y, 0.5 } rotate <20, 30, 0> }
#declare Notched = difference { box { -0.8, 0.8 } box { <0.1, 0.1, -0.8 - Over>, 0.8 + Over } rotate <10, -40, 0> }
#declare Halves = merge { box { -0.8, <0.1 + Over, 0.8, 0.8> } box { <0.1, -0.8, -0.8>, 0.8 } rotate <10, 30, 0> }
#declare Tunnel = difference {
  box { -0.8, 0.8 }
  #if (Sound)
    box { <-0.4, -0.9, -0.4>, <0.4, 0.9, 0.4> }
  #else
    box { <-0.4, -0.9, -0.4>, <0.4, 0.1, 0.4> }
    box { <-0.4, 0.1, -0.4>, <0.4, 0.9, 0.4> }
  #end
  rotate <20, 30, 0>
}
#declare Crossed = intersection {
  box { -0.8, 0.8 }
  box { -2, 2 }
  #if (!Sound) box { <-0.8, -1, -1>, <0.8, 1, 1> } box { <-1, -0.8, -1>, <1, 0.8, 1> } box { <-1, -1, -0.8>, <1, 1, 0.8> } #end
  rotate <20, 30, 0>
}
#declare Hemispheres = #if (Sound) object { Ball } #else
  merge { intersection { object { Ball } plane { y, 0.1 } } intersection { object { Ball } plane { -y, -0.1 } } rotate <30, 0, 20> } #end
#declare Rings = #if (Sound) torus { 0.6, 0.3 rotate x*-40 } #else
  merge {
    intersection { torus { 0.6, 0.3 } plane { x, 0 } }
    intersection { torus { 0.6, 0.3 } plane { -x, 0 } }
    rotate x*-40
  } #end
#declare Tower = merge {
  box { <-0.8, -1, -0.6>, <0.8, -0.3, 0.6> }
  cylinder { (-0.3 - Over)*y, 0.3*y, 0.5 }
  cone { (0.3 - Over)*y, 0.5, 0.8*y, 0.2 }
  rotate <10, 20, 0>
}
#declare Stamped = difference {
  box { -0.8, 0.8 }
  prism { -0.8 - Over, 0.8 + Over, 4 <-0.5, -0.5>, <0.6, -0.4>, <0, 0.6>, <-0.5, -0.5> }
  rotate <20, 30, 0>
}
#declare Nothing = difference { object { Ball } object { Ball } }
#macro Pane (Gap) box { <-0.7, -1.003 + (Sound ? 0.001 : Gap), -0.7>, <0.7, -0.5, 0.7> pigment { rgbt 0.8 } finish { ambient 0 diffuse 0.3 } } #end
// A tumbler of water: how far that goes into the glass.
#macro Tumbler (Depth)
  difference {
    cylinder { -y, 0.8*y, 0.8 }
    cylinder { -0.8*y, 0.9*y, 0.7 }
    pigment { rgbt 0.97 } finish { ambient 0 diffuse 0 } interior { ior 1.5 }
  }
  cylinder {
    (-0.8 - Depth)*y, 0.4*y, 0.7 + Depth
    pigment { rgbt <0.9, 0.95, 1, 0.97> } finish { ambient 0 diffuse 0 } interior { ior 1.33 }
  }
#end

#switch (Case)
#case (1) // a hole drilled flush with both faces; 2
  object { Drilled material { Solid } }
#break
#case (2) // a hole drilled flush with both faces, in glass; 8
  object { Drilled material { Glass } }
#break
#case (3) // a notch flush with three faces; 2
  object { Notched material { Solid } }
#break
#case (4) // a notch flush with three faces, in glass; 8
  object { Notched material { Glass } }
#break
#case (5) // two halves of a box with a common wall; 2
  object { Halves material { Solid } }
#break
#case (6) // two halves of a box with a common wall, in glass; 2
  object { Halves material { Glass } }
#break
#case (7) // a tunnel cut by two boxes with a common wall; 2
  object { Tunnel material { Solid } }
#break
#case (8) // a tunnel cut by two boxes with a common wall, in glass; 2
  object { Tunnel material { Glass } }
#break
#case (9) // an intersection of boxes with common faces; 0
  object { Crossed material { Solid } }
#break
#case (10) // an intersection of boxes with common faces, in glass; 2
  object { Crossed material { Glass } }
#break
#case (11) // two half balls put together; 2
  object { Hemispheres material { Solid } }
#break
#case (12) // two half balls put together, in glass; 2
  object { Hemispheres material { Glass } }
#break
#case (13) // two half rings put together, in glass; 2
  object { Rings material { Glass } }
#break
#case (14) // a box, a cylinder and a cone on top of each other; 2
  object { Tower material { Solid } }
#break
#case (15) // a box, a cylinder and a cone on top of each other, in glass; 100
  object { Tower material { Glass } }
#break
#case (16) // a prism cut flush out of a box; 2
  object { Stamped material { Solid } }
#break
#case (17) // a prism cut flush out of a box of glass; 8
  object { Stamped material { Glass } }
#break
#case (18) // a ball cut out of itself; 0
  #if (!Sound) object { Nothing material { Solid } } #end
#break
#case (19) // a ball of glass cut out of itself; 0
  #if (!Sound) object { Nothing material { Glass } } #end
#break
#case (20) // the tops of two boxes in one plane, the first shows; 2
  union {
    box { <-0.8, -1, -0.6>, <0.2, 0, 0.6> pigment { rgb x } }
    box { <-0.2, -1, -0.7>, <0.9, -Over/10, 0.4> pigment { rgb z } }
    finish { ambient 0.1 diffuse 0.8 }
  }
#break
#case (21) // clear glass 7e-5 above the floor; 8
  Pane(7e-5)
#break
#case (22) // clear glass 7e-7 above the floor; 8
  Pane(7e-7)
#break
#case (23) // clear glass 7e-9 above the floor; 8
  Pane(7e-9)
#break
#case (24) // water that overlaps its glass by 1e-6; 8
  Tumbler((Sound ? 1e-4 : 1e-6))
#break
#case (25) // water that overlaps its glass by 1e-9; 8
  Tumbler((Sound ? 1e-4 : 1e-9))
#break
#case (26) // water a gap of 1e-6 away from its glass; 8
  Tumbler((Sound ? -1e-4 : -1e-6))
#break
#case (27) // water that just touches its glass; 8
  Tumbler((Sound ? 1e-4 : 0))
#break
#case (28) // a disc lying on a box, the disc is written first; 2
  disc { (0.2 + Over/10)*y, y, 0.5 pigment { rgb x } finish { ambient 0.1 diffuse 0.8 } }
  box { <-0.7, -1, -0.7>, <0.7, 0.2, 0.7> material { Solid } }
#break
#end
