# Completion for bash: commands and options as `thercon --help` lists them, else files.
_thercon() {
   local help words
   help=$(thercon --help)
   if ((COMP_CWORD == 1)); then
      words=$(sed -n 's/^\(usage:\|      \) thercon \([a-z]*\).*/\2/p' <<<"$help")
   fi
   [[ $2 == -* ]] && words=$(grep -o -- '--[a-z]*' <<<"$help")
   mapfile -t COMPREPLY < <(compgen -W "$words" -- "$2")
   ((${#COMPREPLY[@]})) || mapfile -t COMPREPLY < <(compgen -f -- "$2")
}
complete -o filenames -F _thercon thercon
