#!/usr/bin/perl
# Every shape of scenes/every_shape.inc against povray: one of them fills the view, 640x480, one
# light, one sample a pixel.  Then a mesh of a million triangles and 100,000 differences.
#
#     tests/bench/shapes.pl [-n ROUNDS] [NAME...]
#
# Both programs run in turn, ROUNDS times (3), and the least counts, of whole runs from the scene
# file to the PNG.  Wall: what one waits for, both on all processors; work: processor time of all
# threads.  povray waits for half a second whatever it renders; that is in the wall times only.
# SPDX-License-Identifier: Apache-2.0
use strict;
use warnings;
use File::Temp 'tempdir';
use Getopt::Long;
use Time::HiRes 'time';

my $pms    = $ENV{PMS} || 'build/release/pms';
my $list   = 'scenes/every_shape.inc';
my $folder = tempdir(CLEANUP => 1);
my $rounds = 3;
my $limit  = 60; # seconds: what takes povray longer is as fast as that for the means
GetOptions('n=i' => \$rounds) or die "usage: shapes.pl [-n ROUNDS] [NAME...]\n";

# --- running ------------------------------------------------------------------------------------

# Run a command; returns its wall and processor seconds, of what is stopped those until then.
sub run_once {
    my $command = shift;
    my ($begin, @before) = (time, times);
    my $status = system("timeout -k 1 $limit $command >$folder/out 2>&1") >> 8;
    $status == 0 || $status == 124 || $status == 137 or die "failed: $command\n" . `tail -5 $folder/out`;
    my ($end, @after) = (time, times);
    return ($end - $begin, $after[2] + $after[3] - $before[2] - $before[3]);
}

# Run both programs on a scene file, in turn; returns the least seconds: of povray wall and work,
# then of pms.
sub measure {
    my $scene = shift;
    my @size  = (640, 480);
    my @least = (9e9) x 4;
    for (1 .. $rounds) {
        my @now = (
            run_once("povray +I$scene +Lscenes +O$folder/povray.png +W$size[0] +H$size[1] -D -A"),
            run_once("$pms $scene -L scenes -w $size[0] --height $size[1] -o $folder/pms.png"));
        for my $i (0 .. 3) { $least[$i] = $now[$i] if $now[$i] < $least[$i] }
        last if $now[0] >= $limit;
    }
    return @least;
}

sub write_scene {
    my ($name, $text) = @_;
    my $path = "$folder/$name.pov";
    open(my $file, '>', $path) or die "$path: $!\n";
    print $file "#version 3.7;\nglobal_settings { assumed_gamma 1 }\n$text";
    close($file) or die "$path: $!\n";
    return $path;
}

# --- scenes -------------------------------------------------------------------------------------

my $look = "pigment { rgb <.9, .5, .3> } finish { ambient .1 }";

sub shape_scene {
    my $number = shift;
    return <<"END";
#include "every_shape.inc"
camera { location <.3, .5, -2.3> look_at 0 angle 50 }
light_source { <5, 9, -7>, 1 }
object { Every_Shape($number) $look }
END
}

# A sheet of 2 x 707^2 triangles with normals.
sub mesh_scene {
    my $side = 707;
    my (@points, @normals, @faces);
    for my $j (0 .. $side) {
        for my $i (0 .. $side) {
            my ($x, $z) = (2 * $i / $side - 1, 2 * $j / $side - 1);
            push @points, sprintf('<%.5f,%.5f,%.5f>', $x, .2 * sin(9 * $x) * cos(8 * $z), $z);
            push @normals, sprintf('<%.4f,%.4f,%.4f>', -1.8 * cos(9 * $x) * cos(8 * $z), 1,
                1.6 * sin(9 * $x) * sin(8 * $z));
            next if $i == $side || $j == $side;
            my $at = $j * ($side + 1) + $i;
            push @faces, sprintf('<%d,%d,%d>', $at, $at + 1, $at + $side + 1),
                sprintf('<%d,%d,%d>', $at + 1, $at + $side + 2, $at + $side + 1);
        }
    }
    my $lists = join "\n", map { "$_->[0] { " . @{$_->[1]} . ",\n" . join(",\n", @{$_->[1]}) . " }" }
        (['vertex_vectors', \@points], ['normal_vectors', \@normals], ['face_indices', \@faces]);
    return "camera { location <0, 1.8, -2.2> look_at <0, -.1, 0> angle 50 }\n"
        . "light_source { <5, 9, -7>, 1 }\nmesh2 {\n$lists\n$look }\n";
}

sub csg_scene {
    return <<"END";
camera { location <0, 40, -60> look_at <0, 0, -2> angle 60 }
light_source { <50, 90, -70>, 1 }
#declare Dice = seed(3);
#declare J = 0;
#while (J < 100000)
  difference {
    box { -.12, .12 }
    sphere { <0, .1, -.1>, .06 + .06*rand(Dice) }
    cylinder { -.2*x, .2*x, .05 }
    $look
    translate <mod(J, 400) * .25 - 50, 0, div(J, 400) * .25 - 30>
  }
  #declare J = J + 1;
#end
END
}

# --- the table ----------------------------------------------------------------------------------

my (@log_wall, @log_work, @slower);

sub show {
    my ($name, @t) = @_;
    $name .= ' (povray stopped)' if $t[0] >= $limit;
    printf "  %-32s %7.2f %7.2f   %7.2f %7.2f   %6.2f %6.2f\n", $name, @t, $t[0] / $t[2],
        $t[1] / $t[3];
}

# The names are in the comments behind the numbers.
sub shapes {
    open(my $file, '<', $list) or die "$list: $!\n";
    my @found;
    while (<$file>) {
        push @found, [$1, $2] if m{^\s*#case \((\d+)\) // ([^,\n]+)};
    }
    return @found;
}

sub is_wanted {
    my $name = shift;
    return !@ARGV || grep { $_ eq $name } @ARGV;
}

sub mean { my $sum = 0; $sum += $_ for @_; return @_ ? exp($sum / @_) : 0 }

printf "  %-32s %-16s  %-16s  %s\n", '', 'povray, seconds', 'pms', 'times as fast';
printf "  %-32s %7s %7s   %7s %7s   %6s %6s\n", 'shape', ('wall', 'work') x 3;
for my $shape (shapes()) {
    my ($number, $name) = @$shape;
    next unless is_wanted($name);
    my @t = measure(write_scene('shape', shape_scene($number)));
    show($name, @t);
    push @log_wall, log($t[0] / $t[2]);
    push @log_work, log($t[1] / $t[3]);
    push @slower, "$name (wall)" if $t[0] < $t[2];
    push @slower, "$name (work)" if $t[1] < $t[3];
}
die "no such shape: @ARGV\n" unless @log_wall || grep { /million|differences/ } @ARGV;
printf "%d shapes, geometric means: wall %.2f, work %.2f (reach 4); slower than povray: %s\n",
    scalar @log_wall, mean(@log_wall), mean(@log_work), @slower ? join(', ', @slower) : 'none'
    if @log_wall;
for my $big (['million triangles', \&mesh_scene, 10], ['100,000 differences', \&csg_scene, 5]) {
    my ($name, $scene, $reach) = @$big;
    next unless is_wanted($name);
    my @t = measure(write_scene('big', $scene->()));
    show("$name (reach $reach)", @t);
}
