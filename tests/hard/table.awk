# The table of the hard cases, from the output of their tests: for the terminal, and as README.md.
# SPDX-License-Identifier: Apache-2.0

function file_name(path) {
    sub(/.*\//, "", path)
    sub(/(_test)?(opaque|glass)?\.log$/, "", path)
    return path
}

# "NAME: REST" in text: sets name and rest.
function split_name(text) {
    at = index(text, ": ")
    name = substr(text, 1, at - 1)
    rest = substr(text, at + 2)
}

FNR == 1 { current = file_name(FILENAME) }

/^# hard: / {
    split_name(substr($0, 9))
    open_at = match(rest, / \([^(]*\)$/)
    count++
    names[count] = name
    files[count] = current
    measured[name] = substr(rest, 1, open_at - 1)
    limit[name] = substr(rest, open_at + 2, length(rest) - open_at - 2)
    has_rows[current] = 1
}

/^# povray: / {
    split_name(substr($0, 11))
    split(rest, parts, ": ")
    verdict[name] = parts[1]
    povray[name] = parts[2]
    povray_count[parts[1]]++
}

/^(not )?ok [0-9]/ {
    is_bad = /^not ok/
    test = $0
    sub(/^(not )?ok [0-9]* *-? */, "", test)
    tests[++test_count] = test
    test_file[test_count] = current
    test_bad[test_count] = is_bad
    bad[test] = is_bad
    failures += is_bad
}

function plain(test) {
    sub(/^test_/, "", test)
    gsub(/_/, " ", test)
    return test
}

# Tests without rows of their own.
function add_tests() {
    for (i = 1; i <= test_count; i++) {
        if (has_rows[test_file[i]])
            continue
        name = plain(test_file[i]) ": " plain(tests[i])
        count++
        names[count] = name
        files[count] = test_file[i]
        measured[name] = test_bad[i] ? "not as expected" : "as expected"
        limit[name] = ""
    }
}

function pms_of(name) {
    return measured[name] (limit[name] == "" ? "" : " (" limit[name] ")") (bad[name] ? " FAILED" : "")
}

function povray_of(name) {
    if (!(name in verdict))
        return "-"
    return verdict[name] (povray[name] == "" ? "" : ", " povray[name])
}

# Shapes: "SHAPE, MATERIAL, MOVE" makes a row and a column.
function print_shapes(    i, parts, row, move) {
    for (i = 1; i <= count; i++) {
        if (files[i] != "shape_cases")
            continue
        split(names[i], parts, ", ")
        row = parts[1] ", " parts[2]
        move = parts[3]
        if (!(move in has_move)) {
            has_move[move] = 1
            moves[++move_count] = move
        }
        if (!(row in has_row)) {
            has_row[row] = 1
            rows[++row_count] = row
        }
        cell[row, move] = measured[names[i]]
        sub(/ pixels.*/, "", cell[row, move])
        word = verdict[names[i]]
        if (word != "") {
            number = povray[names[i]]
            sub(/ pixels/, "", number)
            sub(/no picture of/, "no picture", number)
            cell[row, move] = cell[row, move] " / " word (word == "passes" ? "" : " " number)
        }
    }
    line = "| shape"
    rule = "|---"
    for (i = 1; i <= move_count; i++) {
        line = line " | " moves[i]
        rule = rule "|---"
    }
    print line " |\n" rule "|" >readme
    for (i = 1; i <= row_count; i++) {
        line = "| " rows[i]
        for (k = 1; k <= move_count; k++)
            line = line " | " cell[rows[i], moves[k]]
        print line " |" >readme
    }
}

function print_readme(    i) {
    print "# Hard cases\n" >readme
    print "Cases that break renderers: sizes from a millionth to a million, places far from the origin, surfaces" >readme
    print "that coincide, bodies as thin as paper and thinner, rays that graze.  `make check-hard` runs them all with" >readme
    print "long counts and writes this page; `make check` runs the same with short ones.\n" >readme
    if (failures)
        printf "pms passes %d of the %d cases.", count - failures, count >readme
    else
        printf "pms passes all of the %d cases.", count >readme
    printf "  povray 3.7, on the same files, passes %d, struggles with %d and fails %d of the %d that it can be\n", povray_count["passes"], povray_count["struggles"], povray_count["fails"], povray_count["passes"] + povray_count["struggles"] + povray_count["fails"] >readme
    print "asked.  It *struggles* where the limit is exceeded and at most 192 of 19200 pixels (1 %) are visibly wrong (by more" >readme
    print "than 1/255); it *fails* where more are.  Its pictures have 16 bits a channel, so that it is looked at as closely.\n" >readme
    print "## Every shape\n" >readme
    print "The shapes of `scenes/every_shape.inc` over a checkered floor; a picture of the scene, moved as the column says, is" >readme
    print "compared with that of the scene as it stands.  Each field says how many pixels of 19200 changed: in pms, then what povray" >readme
    print "does and how many changed in it.  Where the scene is scaled by powers of two, no bit of pms's picture may change; else" >readme
    print "a pixel counts if it changed by more than 1/255, and 2 may.  At 1e8 a place is known to a millionth at best: there 20 may, and" >readme
    print "twice as many as would if the shape changed by that.  The worst of all tries is shown: of 40 powers of two, of 12 powers of ten" >readme
    print "and so on; povray is asked for four of each at most.  Of scenes that are too small it makes no picture: it takes the" >readme
    print "eye to be where it looks to.\n" >readme
    print_shapes()
    print "\n## Other scenes and numbers\n" >readme
    print "| case | pms (limit) | povray 3.7 |\n|---|---|---|" >readme
    for (i = 1; i <= count; i++)
        if (files[i] != "shape_cases")
            print "| " names[i] " | " pms_of(names[i]) " | " povray_of(names[i]) " |" >readme
}

END {
    add_tests()
    printf "%-72s %-44s %s\n", "case", "pms (limit)", "povray"
    for (i = 1; i <= count; i++)
        printf "%-72s %-44s %s\n", names[i], pms_of(names[i]), povray_of(names[i])
    for (i = 1; i <= test_count; i++)
        if (test_bad[i])
            print "FAILED: " test_file[i] ": " tests[i]
    printf "%d cases, %d tests failed; povray passes %d, struggles with %d, fails %d\n", count, failures, povray_count["passes"], povray_count["struggles"], povray_count["fails"]
    print_readme()
    exit failures > 0 || count == 0
}
