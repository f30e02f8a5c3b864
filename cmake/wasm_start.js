// Node has a fetch() that takes no names of files; without it the program is read as a file.
var fetch;
