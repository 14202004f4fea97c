# Completions of kage for fish. `kage complete` knows what may follow; this only asks it.

function __kage_complete
    set -l words (commandline -opc) (commandline -ct)
    set -l program $words[1]
    set -e words[1]
    # Quotes are the shell's.
    set words[-1] (string trim --left --chars "'\"" -- $words[-1])
    for line in ($program complete $words 2>/dev/null)
        set -l kind (string sub --length 1 -- $line)
        set -l parts (string split --max 1 \t -- (string sub --start 2 -- $line))
        if test "$kind" != .
            printf '%s\t%s\n' $parts[1] "$parts[2]"
            continue
        end
        set -l size (string length -- "$parts[1]")
        set -l start (string sub --start (math $size + 1) -- $words[-1])
        set -l found $start*
        for file in $found
            if test -d $file
                printf '%s%s/\n' "$parts[1]" $file
            else
                for ending in (string split ' ' -- $parts[2])
                    string match --quiet --ignore-case "*$ending" -- $file
                    and printf '%s%s\n' "$parts[1]" $file
                end
            end
        end
    end
end

complete --command kage --no-files --arguments '(__kage_complete)'
