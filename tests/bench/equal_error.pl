#!/usr/bin/perl
# Row S16: equal error on a caustic, how long photons, paths and povray take to be as wrong as each
# other.
#
# Error is the root mean square over a rectangle around the caustic, against a picture of very many
# photons: pms against its own, povray against povray's own, so that neither pays for what the two
# see differently.  Time is processor time of the whole program, one thread.  Paths have no bias:
# their time at another error follows from the square.  povray's is read off the line through its
# measured points, both axes logarithmic.  SPDX-License-Identifier: Apache-2.0
use strict;
use warnings;
use File::Temp 'tempdir';

my $pms    = $ENV{PMS} || 'build/release/pms';
my $scene  = 'tests/bench/caustic.pov';
my @size   = (160, 120);
my $region = '94,60,50,38';
my @seeds  = (1, 2, 3);
my @points = ([20000, 60], [80000, 120], [320000, 250], [1280000, 500]);
my @truth  = (30000000, 2000);
my @povray_truth = (8000000, 1000);
my $paths = 256;    # a pixel
my $folder = tempdir(CLEANUP => 1);

# Run a command; returns its processor seconds.
sub seconds {
    my @before = times;
    open(my $out, '>&', \*STDOUT) or die;
    open(my $err, '>&', \*STDERR) or die;
    open(STDOUT, '>', '/dev/null');
    open(STDERR, '>', '/dev/null');
    my $failed = system(@_);
    open(STDOUT, '>&', $out);
    open(STDERR, '>&', $err);
    die "failed: @_\n" if $failed;
    my @after = times;
    return $after[2] + $after[3] - $before[2] - $before[3];
}

sub pms {
    my ($file, $seed, @options) = @_;
    return seconds($pms, $scene, '-w', $size[0], '--height', $size[1], '-j', 1, '--seed', $seed,
        '--progress', 'none', '-o', "$folder/$file", @options);
}

sub photons {
    my ($file, $seed, $point, @options) = @_;
    return pms($file, $seed, '-d', "Count=$point->[0]", '-d', "Gather=$point->[1]", @options);
}

sub povray {
    my ($file, $point) = @_;
    return seconds('povray', "+I$scene", "+W$size[0]", "+H$size[1]", '-A', '-D', '+WT1', '+FE',
        "Declare=Count=$point->[0]", "Declare=Gather=$point->[1]", "+O$folder/$file");
}

sub rmse {
    my ($file, $reference) = @_;
    my $json = `$pms compare $folder/$file $folder/$reference --region $region --json`;
    $json =~ /"rmse": ([^,]+)/ or die "cannot compare $file with $reference\n";
    return $1;
}

sub mean { my $sum = 0; $sum += $_ for @_; return $sum / @_ }

# Half the range of some numbers, as a part of their mean.
sub spread {
    my @sorted = sort { $a <=> $b } @_;
    return ($sorted[-1] - $sorted[0]) / 2 / mean(@_);
}

# The time at an error, on the line through the two points next to it.
sub time_at {
    my ($error, @known) = @_;    # [seconds, error], errors falling
    my $i = 0;
    $i++ while $i < $#known - 1 && $known[$i + 1][1] > $error;
    my ($a, $b) = @known[$i, $i + 1];
    my $slope = log($b->[0] / $a->[0]) / log($b->[1] / $a->[1]);
    return $a->[0] * ($error / $a->[1])**$slope;
}

photons('truth.exr', 99, \@truth, '-A');
photons('smooth.exr', 99, \@truth, '--aa', 16);

my (@path_time, @path_error);
for my $seed (@seeds) {
    push @path_time, pms('path.exr', $seed, '--integrator', 'path', '--aa', $paths);
    push @path_error, rmse('path.exr', 'smooth.exr');
}
my ($path_time, $path_error) = (mean(@path_time), mean(@path_error));

my @povray;
if (system('command -v povray >/dev/null 2>&1') == 0) {
    povray('povray_truth.exr', \@povray_truth);
    for my $point (@points, [5120000, 1000]) {
        my $time = povray('povray.exr', $point);
        push @povray, [$time, rmse('povray.exr', 'povray_truth.exr')];
    }
}

print "equal error on a caustic, processor seconds, one thread, three seeds\n";
printf "  %8s %6s %8s %16s %10s %16s %9s %6s\n", 'photons', 'gather', 'seconds', 'rmse',
    'paths', 'times (reach 20)', 'povray', 'times';
my (@against_paths, @against_povray);
for my $point (@points) {
    my (@time, @error);
    for my $seed (@seeds) {
        push @time, photons('photons.exr', $seed, $point, '-A');
        push @error, rmse('photons.exr', 'truth.exr');
    }
    my ($time, $error) = (mean(@time), mean(@error));
    my $by_paths = $path_time * ($path_error / $error)**2;
    push @against_paths, $by_paths / $time;
    printf "  %8d %6d %8.3f %8.4f +-%4.0f %% %10.1f %16.0f", @$point, $time, $error,
        100 * spread(@error), $by_paths, $by_paths / $time;
    if (@povray) {
        my $by_povray = time_at($error, @povray);
        push @against_povray, $by_povray / $time;
        printf " %9.3f %6.1f", $by_povray, $by_povray / $time;
    }
    print "\n";
}
sub geometric { return exp(mean(map { log } @_)) }
printf "  geometric mean: %.0f times less than paths (reach 20; their rmse varies by %.0f %%)",
    geometric(@against_paths), 100 * spread(@path_error);
printf ", %.1f times less than povray (reach 5)", geometric(@against_povray) if @against_povray;
print "\n";
