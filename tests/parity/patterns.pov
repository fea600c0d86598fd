// Checker, gradient and colour maps with every wave and transform.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { orthographic location <0, 0, -10> look_at 0 right 8 * x up 6 * y }
light_source { <0, 0, -100>, 1 }
#declare Map = color_map { [0 rgb <1, .2, .1>] [.4 rgb <.9, .9, .2>] [.4 rgb <.1, .3, .8>] [1 rgb <.1, .9, .7>] }
#macro Tile(X, Y, P) box { <X, Y, 0>, <X + 1.9, Y + 1.9, 1> pigment { P } finish { ambient .3 } } #end
Tile(-3.95, .95, pigment { gradient x color_map { Map } })
Tile(-1.95, .95, pigment { gradient <1, 2, 0> color_map { Map } scale .7 })
Tile(.05, .95, pigment { gradient y color_map { Map } sine_wave frequency 2 })
Tile(2.05, .95, pigment { gradient y color_map { Map } triangle_wave phase .3 })
Tile(-3.95, -1.05, pigment { gradient x color_map { Map } scallop_wave })
Tile(-1.95, -1.05, pigment { gradient x color_map { Map } cubic_wave rotate 30 * z })
Tile(.05, -1.05, pigment { gradient x color_map { Map } poly_wave 2 scale <.5, 1, 1> })
Tile(2.05, -1.05, pigment { checker rgb <.9, .1, .1> rgb <.1, .1, .9> scale .4 translate .1 })
Tile(-3.95, -3.05, pigment { checker pigment { gradient y color_map { Map } scale .3 } pigment { rgb .5 } rotate 20 * z })
Tile(-1.95, -3.05, pigment { gradient x color_map { [0 rgb 0] [1 rgb 1] } frequency 3 phase .25 })
Tile(.05, -3.05, pigment { rgb <.3, .6, .2> })
Tile(2.05, -3.05, pigment { gradient z color_map { Map } translate .4 * z })
