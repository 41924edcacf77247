//! What each file of a crate imports, read from its tokens.

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};

/// Imports of each file of one crate: edges from file to file.
pub(crate) type Imports = BTreeMap<PathBuf, BTreeSet<PathBuf>>;

/// A module: where it is written, what lies in it, and what its `use` lines call by which name.
struct Module {
    file: PathBuf,
    parent: usize,
    children: HashMap<String, usize>,
    names: HashMap<String, Vec<String>>,
}

/// The modules of a crate, and each path that their code mentions.
#[derive(Default)]
struct Crate {
    modules: Vec<Module>,
    paths: Vec<(usize, Vec<String>)>,
}

/// Reads the crate whose root is this file, without what is compiled for tests only.
///
/// A path leads to the file that defines what it names: re-exports are followed. Mentions in
/// comments, in attributes and as the extent of a visibility are no imports.
pub(crate) fn of_crate(root: &Path) -> Imports {
    let mut all = Crate::default();
    all.load(root.to_path_buf(), 0);
    let mut imports = Imports::new();
    for module in &all.modules {
        imports.entry(module.file.clone()).or_default();
    }
    for (module, path) in &all.paths {
        let from = &all.modules[*module].file;
        if let Some(to) = all.definition(*module, path, 0)
            && to != from
        {
            imports.entry(from.clone()).or_default().insert(to.clone());
        }
    }
    imports
}

impl Crate {
    /// Reads the file of a module and those of its children.
    fn load(&mut self, file: PathBuf, parent: usize) -> usize {
        let text = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        let tokens: TokenStream = text.parse().unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        let module = self.add(file, parent);
        self.read(module, tokens);
        module
    }

    fn add(&mut self, file: PathBuf, parent: usize) -> usize {
        self.modules.push(Module { file, parent, children: HashMap::new(), names: HashMap::new() });
        self.modules.len() - 1
    }

    /// Reads tokens that lie in a module: its declarations, its `use` lines and every other path.
    fn read(&mut self, module: usize, tokens: TokenStream) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut k = 0;
        // What an attribute says of the place of the next module.
        let mut place = None;
        while k < tokens.len() {
            match &tokens[k] {
                TokenTree::Punct(p) if p.as_char() == '#' => {
                    let inner = usize::from(is_punct(tokens.get(k + 1), '!'));
                    let text = tokens.get(k + 1 + inner).map_or(String::new(), |t| t.to_string().replace(' ', ""));
                    k += 2 + inner;
                    if let Some(path) = text.strip_prefix("[path=\"").and_then(|rest| rest.strip_suffix("\"]")) {
                        place = Some(path.to_owned());
                    } else if text == "[cfg(test)]" {
                        k += tokens[k..].iter().position(ends_item).map_or(tokens.len(), |at| at + 1);
                    }
                }
                TokenTree::Ident(word) if word == "pub" => k += 1 + usize::from(is_extent(tokens.get(k + 1))),
                TokenTree::Ident(word) if word == "mod" && is_ident(tokens.get(k + 1)) => {
                    self.declare(module, &tokens[k + 1].to_string(), tokens.get(k + 2), place.take());
                    k += 3;
                }
                TokenTree::Ident(word) if word == "use" => {
                    let end = k + tokens[k..].iter().position(|t| is_punct(Some(t), ';')).unwrap_or(tokens.len() - k);
                    self.use_tree(module, &tokens[(k + 1).min(end)..end], &[]);
                    k = end + 1;
                }
                TokenTree::Ident(_) => {
                    let (path, length) = path(&tokens[k..]);
                    k += length;
                    if path.len() > 1 {
                        self.paths.push((module, path));
                    }
                }
                TokenTree::Group(group) => {
                    self.read(module, group.stream());
                    k += 1;
                }
                _ => k += 1,
            }
        }
    }

    fn declare(&mut self, module: usize, name: &str, body: Option<&TokenTree>, place: Option<String>) {
        let file = self.modules[module].file.clone();
        let child = match body {
            Some(TokenTree::Group(group)) => {
                let child = self.add(file, module);
                self.read(child, group.stream());
                child
            }
            _ => {
                let stem = file.file_stem().expect("a file has a name").to_owned();
                let beside = file.parent().expect("a file lies in a folder");
                let is_root = ["mod", "lib", "main"].iter().any(|root| stem == *root);
                let folder = if is_root { beside.to_path_buf() } else { beside.join(stem) };
                let flat = folder.join(format!("{name}.rs"));
                let usual = if flat.exists() { flat } else { folder.join(name).join("mod.rs") };
                self.load(place.map_or(usual, |path| beside.join(path)), module)
            }
        };
        self.modules[module].children.insert(name.to_owned(), child);
    }

    /// Reads what stands after `use`, or in its braces.
    fn use_tree(&mut self, module: usize, tokens: &[TokenTree], prefix: &[String]) {
        for tree in tokens.split(|t| is_punct(Some(t), ',')) {
            let (names, length) = path(tree);
            let mut whole = [prefix, &names].concat();
            if whole.last().is_some_and(|last| last == "self") && !prefix.is_empty() {
                whole.pop();
            }
            match tree.iter().find_map(|t| if let TokenTree::Group(group) = t { Some(group.stream()) } else { None }) {
                Some(inner) => self.use_tree(module, &inner.into_iter().collect::<Vec<_>>(), &whole),
                None if !whole.is_empty() => {
                    let renamed = tree.get(length).is_some_and(|t| t.to_string() == "as");
                    let name = if renamed { tree[length + 1].to_string() } else { whole[whole.len() - 1].clone() };
                    self.modules[module].names.insert(name, whole.clone());
                    self.paths.push((module, whole));
                }
                None => {}
            }
        }
    }

    /// The file that defines what a path names; `None` for what is of another crate or of the same
    /// scope.
    fn definition(&self, module: usize, path: &[String], depth: usize) -> Option<&PathBuf> {
        assert!(depth < 100, "{}: re-exports in a circle: {}", self.modules[module].file.display(), path.join("::"));
        let (mut at, mut k) = (module, 0);
        while k < path.len() {
            let Module { parent, children, names, file } = &self.modules[at];
            match path[k].as_str() {
                "crate" => at = 0,
                "self" => {}
                "super" => at = *parent,
                name => {
                    if let Some(&child) = children.get(name) {
                        at = child;
                    } else if let Some(target) = names.get(name).filter(|target| target[0] != name) {
                        return self.definition(at, &[target, &path[k + 1..]].concat(), depth + 1);
                    } else {
                        return (k > 0).then_some(file);
                    }
                }
            }
            k += 1;
        }
        Some(&self.modules[at].file)
    }
}

/// The path that begins here, and how many tokens it takes.
fn path(tokens: &[TokenTree]) -> (Vec<String>, usize) {
    let (mut names, mut k) = (Vec::new(), 0);
    while let Some(TokenTree::Ident(name)) = tokens.get(k) {
        names.push(name.to_string());
        k += 1;
        if !(is_punct(tokens.get(k), ':') && is_punct(tokens.get(k + 1), ':')) {
            break;
        }
        k += 2;
    }
    (names, k.max(1))
}

fn is_punct(token: Option<&TokenTree>, wanted: char) -> bool {
    matches!(token, Some(TokenTree::Punct(p)) if p.as_char() == wanted)
}

fn is_ident(token: Option<&TokenTree>) -> bool {
    matches!(token, Some(TokenTree::Ident(_)))
}

/// Whether an item ends here: at a semicolon or after its braces.
fn ends_item(token: &TokenTree) -> bool {
    is_punct(Some(token), ';') || matches!(token, TokenTree::Group(group) if group.delimiter() == Delimiter::Brace)
}

/// Whether this says how far an item is visible: `(crate)`, `(super)`, `(in ...)`.
fn is_extent(token: Option<&TokenTree>) -> bool {
    let Some(TokenTree::Group(group)) = token else { return false };
    let text = group.stream().to_string();
    group.delimiter() == Delimiter::Parenthesis
        && (["crate", "super", "self"].contains(&text.as_str()) || text.starts_with("in "))
}
