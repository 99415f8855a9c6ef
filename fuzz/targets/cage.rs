#![no_main]
//! Cages as OBJ and JSON, and what is made of those that can be read.
use trisect::subdivision::{ControlMesh, Rules};
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let obj = ControlMesh::from_obj(bytes, Rules::Loop).ok().map(|(cage, _)| cage);
    for cage in obj.into_iter().chain(ControlMesh::from_json(bytes).ok()) {
        let again = ControlMesh::from_json(cage.to_json().as_bytes()).expect("its own file");
        assert_eq!((again.positions(), again.faces()), (cage.positions(), cage.faces()));
        if cage.faces().len() < 64 && cage.details().len() < 3 {
            let _ = (cage.subdivided(1).is_ok(), cage.limit_mesh_of_steps(2).is_ok());
        }
    }
});
