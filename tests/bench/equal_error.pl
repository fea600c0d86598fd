#!/usr/bin/perl
# Row S16: equal error, how long photons, paths and povray take to be as wrong as each other, on a
# caustic, on a spotlight in smoke and on the indirect light of two rooms.
#
#     tests/bench/equal_error.pl [caustic | smoke | room | window]...
#
# Error is the root mean square over the picture, or over a rectangle around the caustic.  Caustics
# and smoke are compared with pictures of very many photons or samples, each program's with its own,
# so that neither pays for what the two see differently; indirect light with very many paths.  Time
# is processor time of the whole program, one thread.  Paths have no bias: their time at another
# error follows from its square.  povray's is read off the line through its measured points, both
# axes logarithmic.  SPDX-License-Identifier: Apache-2.0
use strict;
use warnings;
use File::Temp 'tempdir';

my $pms    = $ENV{PMS} || 'build/release/pms';
my @seeds  = (1, 2, 3);
my $folder = tempdir(CLEANUP => 1);
my $has_povray = system('command -v povray >/dev/null 2>&1') == 0;

# --- running ------------------------------------------------------------------------------------

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

# Render a scene, a hash of name, width, height and region; values are declared in it.
sub pms {
    my ($scene, $file, $seed, $values, @options) = @_;
    return seconds($pms, "tests/bench/$scene->{name}.pov", '-w', $scene->{width}, '--height',
        $scene->{height}, '-j', 1, '--seed', $seed, '--progress', 'none', '-o', "$folder/$file",
        (map { ('-d', "$_=$values->{$_}") } sort keys %$values), @options);
}

sub povray {
    my ($scene, $file, $values, @options) = @_;
    return seconds('povray', "+Itests/bench/$scene->{name}.pov", "+W$scene->{width}",
        "+H$scene->{height}", '-D', '+WT1', '+FE', "+O$folder/$file", @options,
        map { "Declare=$_=$values->{$_}" } sort keys %$values);
}

sub rmse {
    my ($scene, $file, $reference) = @_;
    my $region = $scene->{region} ? "--crop $scene->{region}" : '';
    my $json   = `$pms compare $folder/$file $folder/$reference $region --json`;
    $json =~ /"rmse": ([^,]+)/ or die "cannot compare $file with $reference\n";
    return $1;
}

# --- figures ------------------------------------------------------------------------------------

sub mean { my $sum = 0; $sum += $_ for @_; return $sum / @_ }
sub geometric { return exp(mean(map { log } @_)) }

# Half the range of some numbers, in percent of their mean.
sub spread {
    my @sorted = sort { $a <=> $b } @_;
    return 50 * ($sorted[-1] - $sorted[0]) / mean(@_);
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

# Seconds and errors of one setting over the seeds, as [mean seconds, mean error, spread].
sub over_seeds {
    my ($scene, $reference, $values, @options) = @_;
    my (@time, @error);
    for my $seed (@seeds) {
        push @time, pms($scene, 'seed.exr', $seed, $values, @options);
        push @error, rmse($scene, 'seed.exr', $reference);
    }
    return [mean(@time), mean(@error), spread(@error)];
}

# --- a caustic ----------------------------------------------------------------------------------

sub caustic {
    my $scene = {name => 'caustic', width => 160, height => 120, region => '94,60,50,38'};
    my @points = map { {Count => $_->[0], Gather => $_->[1]} }
        ([20000, 60], [80000, 120], [320000, 250], [1280000, 500]);
    my $truth = {Count => 30000000, Gather => 2000};
    pms($scene, 'truth.exr',  99, $truth, '-A');
    pms($scene, 'smooth.exr', 99, $truth, '--aa', 16);
    my ($path_time, $path_error, $path_spread) =
        @{over_seeds($scene, 'smooth.exr', {}, '--integrator', 'path', '--aa', 256)};
    my @povray;
    if ($has_povray) {
        povray($scene, 'povray_truth.exr', {Count => 8000000, Gather => 1000}, '-A');
        for my $point (@points, {Count => 5120000, Gather => 1000}) {
            my $time = povray($scene, 'povray.exr', $point, '-A');
            push @povray, [$time, rmse($scene, 'povray.exr', 'povray_truth.exr')];
        }
    }
    print "equal error on a caustic, processor seconds, one thread, three seeds\n";
    printf "  %8s %6s %8s %16s %10s %16s %9s %6s\n", 'photons', 'gather', 'seconds', 'rmse',
        'paths', 'times (reach 20)', 'povray', 'times';
    my (@against_paths, @against_povray);
    for my $point (@points) {
        my ($time, $error, $spread) = @{over_seeds($scene, 'truth.exr', $point, '-A')};
        my $by_paths = $path_time * ($path_error / $error)**2;
        push @against_paths, $by_paths / $time;
        printf "  %8d %6d %8.3f %8.4f +-%4.0f %% %10.1f %16.0f", $point->{Count}, $point->{Gather},
            $time, $error, $spread, $by_paths, $by_paths / $time;
        if (@povray) {
            my $by_povray = time_at($error, @povray);
            push @against_povray, $by_povray / $time;
            printf " %9.3f %6.1f", $by_povray, $by_povray / $time;
        }
        print "\n";
    }
    printf "  geometric mean: %.0f times less than paths (reach 20; their rmse varies by %.0f %%)",
        geometric(@against_paths), $path_spread;
    printf ", %.1f times less than povray (reach 5)", geometric(@against_povray)
        if @against_povray;
    print "\n";
}

# --- light in smoke -----------------------------------------------------------------------------

# Errors are against a picture of very many samples, each program's against its own; that the two
# agree is printed.  The first line of povray is its default setting.
sub smoke {
    my $scene = {name => 'smoke', width => 160, height => 120};
    my @points = map { {Variance => $_} } (1, 1 / 16, 1 / 128, 1 / 512, 1 / 2048);
    pms($scene, 'truth.exr', 99,
        {Samples => 3000, Variance => 1e-8, Threshold => 1e-4, Level => 10}, '-A');
    my @povray;
    if ($has_povray) {
        povray($scene, 'povray_truth.exr', {Samples => 1500, Intervals => 1}, '-A');
        for my $point ({}, map { {Samples => $_} } 30, 100, 300) {
            my $time = povray($scene, 'povray.exr', $point, '-A');
            push @povray, [$time, rmse($scene, 'povray.exr', 'povray_truth.exr')];
        }
    }
    print "\nequal error in smoke, processor seconds, one thread, three seeds\n";
    printf "  the two references, of very many samples, differ by rmse %.4f\n",
        rmse($scene, 'truth.exr', 'povray_truth.exr') if @povray;
    printf "  %8s %8s %16s %9s %6s\n", 'variance', 'seconds', 'rmse', 'povray', 'times';
    my @known;
    for my $point (@points) {
        my ($time, $error, $spread) = @{over_seeds($scene, 'truth.exr', $point, '-A')};
        push @known, [$time, $error];
        printf "  %8s %8.3f %8.4f +-%4.0f %%", '1/' . int(1 / $point->{Variance}), $time, $error,
            $spread;
        if (@povray) {
            my $by_povray = time_at($error, @povray);
            printf " %9.3f %6.1f", $by_povray, $by_povray / $time;
        }
        print "\n";
    }
    return if !@povray;
    # No coarser setting than the first is known: no error above its own is read off the line.
    my ($seconds, $error) = @{$povray[0]};
    my ($least, $coarsest) = @{$known[0]};
    my $time = $coarsest < $error ? $least : time_at($error, @known);
    printf "  povray as it is by default: %.3f s, rmse %.4f; pms for that error or less %.3f s:"
        . " %.1f times less (reach 5)\n", $seconds, $error, $time, $seconds / $time;
}

# --- indirect light -----------------------------------------------------------------------------

sub indirect {
    my ($name, $what, $grid, $paths) = @_;    # grid x grid samples of a pixel
    my $scene = {name => $name, width => 80, height => 60};
    my @points = map { {Count => $_->[0], Bound => $_->[1], Bounces => $_->[2]} }
        ([50, 1, 2], [150, 0.5, 3], [600, 0.25, 5]);
    pms($scene, 'truth.exr', 99, {}, '--integrator', 'path', '--aa', $paths);
    my ($time, $error, $spread) = @{over_seeds($scene, 'truth.exr', {}, '--aa', $grid**2)};
    print "\nequal error on the indirect light of $what, against $paths paths a pixel\n";
    printf "  pms                          %8.3f s, rmse %.4f +- %.0f %%\n", $time, $error, $spread;
    return if !$has_povray;
    my @povray;
    for my $point (@points) {
        my $seconds = povray($scene, 'povray.exr', $point, '+A0.0', '+AM1', "+R$grid", '-J');
        my $rmse = rmse($scene, 'povray.exr', 'truth.exr');
        printf "  povray, count %3d bound %.2f  %8.3f s, rmse %.4f\n", $point->{Count},
            $point->{Bound}, $seconds, $rmse;
        push @povray, [$seconds, $rmse];
    }
    printf "  pms takes %.1f times less than povray's last line (reach 4), at %.1f times less"
        . " error\n", $povray[-1][0] / $time, $povray[-1][1] / $error;
}

my %rows = (
    caustic => \&caustic,
    smoke   => \&smoke,
    room    => sub { indirect('room', 'a room lit from its ceiling', 2, 2048) },
    window  => sub { indirect('window', 'a room lit through a window', 4, 4096) },
);
@ARGV = qw(caustic smoke room window) if !@ARGV;
for my $row (@ARGV) {
    die "no row '$row'\n" if !$rows{$row};
    $rows{$row}->();
}
