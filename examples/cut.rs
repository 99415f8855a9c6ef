//! Two files, one difference, one file: the shortest useful program.
//!
//!     cargo run --release --example cut -- BODY TOOL OUTPUT

use trisect::{Error, Mesh, Operation, Solid, boolean};

fn main() -> Result<(), Error> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [body, tool, output] = arguments.as_slice() else {
        return Err(Error::InvalidArgument("usage: cut BODY TOOL OUTPUT".into()));
    };

    let a = Solid::try_from(Mesh::load(body)?)?;
    let b = Solid::try_from(Mesh::load(tool)?)?;
    let cut = boolean(Operation::Difference, &a, &b)?;
    cut.solid().mesh().save(output)?;

    println!("{}", cut.certificate());
    Ok(())
}
