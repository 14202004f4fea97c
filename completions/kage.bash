# Completions of kage for bash. `kage complete` knows what may follow; this only asks it.

_kage()
{
    local rest=${COMP_LINE:0:COMP_POINT} gap word raw before k line kind text endings name
    local -a words=()
    # Bash breaks words at = and :, kage does not.
    for ((k = 0; k <= COMP_CWORD; k++)); do
        gap=${rest%%[![:space:]]*}
        rest=${rest#"$gap"}
        word=${COMP_WORDS[k]}
        ((k == COMP_CWORD)) && word=$rest
        if ((k > 0)) && [[ -z $gap ]]; then
            words[${#words[@]}-1]+=$word
        else
            words+=("$word")
        fi
        rest=${rest#"$word"}
    done
    raw=${words[${#words[@]}-1]}
    [[ $word == [=:] ]] && word= # it ends the word before
    before=${raw%"$word"} # what bash takes for words before this one
    words=("${words[@]//[\'\"\\]/}")
    words[0]=${COMP_WORDS[0]/#\~/$HOME}
    COMPREPLY=()
    local goes_on=
    while IFS= read -r line; do
        kind=${line:0:1}
        line=${line:1}
        text=${line%%$'\t'*}
        case $kind in
            .)
                endings=${line#*$'\t'}
                compopt -o filenames 2>/dev/null
                while IFS= read -r name; do
                    if [[ -d $name || -z $endings ]]; then
                        COMPREPLY+=("$text$name")
                    else
                        for word in $endings; do
                            [[ ${name,,} == *"$word" ]] && COMPREPLY+=("$text$name")
                        done
                    fi
                done < <(compgen -f -- "${words[${#words[@]}-1]#"$text"}")
                ;;
            + | =)
                [[ $raw != [\'\"]* && $text == *[\ \(\)\*\&\;\|\<\>\'\"\$\`\[\]\{\}]* ]] && printf -v text %q "$text"
                [[ $kind == + ]] && goes_on=yes
                COMPREPLY+=("$text")
                ;;
        esac
    done < <("${words[@]:0:1}" complete "${words[@]:1}" 2>/dev/null)
    [[ $goes_on ]] && compopt -o nospace 2>/dev/null
    for k in "${!COMPREPLY[@]}"; do
        COMPREPLY[k]=${COMPREPLY[k]#"$before"}
    done
}

complete -F _kage kage
