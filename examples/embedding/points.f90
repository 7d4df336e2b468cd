! A model in a Fortran program: a parameter, points, a number and its derivative, panels.
!
!   ln -sf libmoldloft.so ../../target/release/libmoldloft.so.1
!   gfortran points.f90 -L../../target/release -lmoldloft -Wl,-rpath,../../target/release -o points
module moldloft
  use iso_c_binding
  implicit none
  interface
    integer(c_int32_t) function mlf_v1_from_text(text, length, model) bind(c)
      import :: c_char, c_size_t, c_ptr, c_int32_t
      character(kind=c_char), intent(in) :: text(*)
      integer(c_size_t), value :: length
      type(c_ptr), intent(out) :: model
    end function
    integer(c_int32_t) function mlf_v1_set(model, name, length, number) bind(c)
      import :: c_char, c_size_t, c_ptr, c_int32_t, c_double
      type(c_ptr), value :: model
      character(kind=c_char), intent(in) :: name(*)
      integer(c_size_t), value :: length
      real(c_double), value :: number
    end function
    integer(c_int32_t) function mlf_v1_shape(model, name, length, shape) bind(c)
      import :: c_char, c_size_t, c_ptr, c_int32_t
      type(c_ptr), value :: model
      character(kind=c_char), intent(in) :: name(*)
      integer(c_size_t), value :: length
      type(c_ptr), intent(out) :: shape
    end function
    integer(c_int32_t) function mlf_v1_points(shape, n, parameters, xyz) bind(c)
      import :: c_size_t, c_ptr, c_int32_t, c_double
      type(c_ptr), value :: shape
      integer(c_size_t), value :: n
      real(c_double), intent(in) :: parameters(2, *)
      real(c_double), intent(out) :: xyz(3, *)
    end function
    integer(c_int32_t) function mlf_v1_derivative(model, text, length, by, by_length, values, room, count) bind(c)
      import :: c_char, c_size_t, c_ptr, c_int32_t, c_double
      type(c_ptr), value :: model
      character(kind=c_char), intent(in) :: text(*), by(*)
      integer(c_size_t), value :: length, by_length, room
      real(c_double), intent(out) :: values(*)
      integer(c_size_t), intent(out) :: count
    end function
    integer(c_int32_t) function mlf_v1_panel_counts(model, vertices, panels) bind(c)
      import :: c_size_t, c_ptr, c_int32_t
      type(c_ptr), value :: model
      integer(c_size_t), intent(out) :: vertices, panels
    end function
    integer(c_size_t) function mlf_v1_message(buffer, size) bind(c)
      import :: c_char, c_size_t
      character(kind=c_char), intent(out) :: buffer(*)
      integer(c_size_t), value :: size
    end function
    subroutine mlf_v1_shape_free(shape) bind(c)
      import :: c_ptr
      type(c_ptr), value :: shape
    end subroutine
    subroutine mlf_v1_free(model) bind(c)
      import :: c_ptr
      type(c_ptr), value :: model
    end subroutine
  end interface
contains
  subroutine check(code)
    integer(c_int32_t), intent(in) :: code
    character(len=2000, kind=c_char) :: words
    integer(c_size_t) :: length
    if (code == 0) return
    length = mlf_v1_message(words, int(len(words), c_size_t))
    print *, 'error', code, ': ', words(1:min(int(length), len(words)))
    stop 1
  end subroutine
end module

program points
  use moldloft
  implicit none
  character(len=*), parameter :: text = &
    'param float beam = 2 in [1, 3];' // &
    'BCurve keel({{0, 0, 0}, {3, 0, -0.5}, {6, 0, 0}});' // &
    'BCurve sheer({{0, 0, 1}, {3, beam, 1}, {6, 0, 1}});' // &
    'RuledSurf side(keel, sheer, divisions = {20, 5});'
  type(c_ptr) :: model, side
  integer(c_size_t) :: count, vertices, panels
  real(c_double) :: uv(2, 3), xyz(3, 3), slope(1)
  call check(mlf_v1_from_text(text, int(len(text), c_size_t), model))
  call check(mlf_v1_set(model, 'beam', 4_c_size_t, 2.5_c_double))
  call check(mlf_v1_shape(model, 'side', 4_c_size_t, side))
  uv = reshape([0d0, 0d0, 0.5d0, 1d0, 1d0, 1d0], [2, 3])
  call check(mlf_v1_points(side, 3_c_size_t, uv, xyz))
  print '(a, 3f18.14)', 'point ', xyz(:, 2)
  call check(mlf_v1_derivative(model, 'side.area', 9_c_size_t, 'beam', 4_c_size_t, slope, 1_c_size_t, count))
  print '(a, f18.14)', 'derivative ', slope(1)
  call check(mlf_v1_panel_counts(model, vertices, panels))
  print '(i0, a, i0, a)', vertices, ' vertices, ', panels, ' panels'
  call mlf_v1_shape_free(side)
  call mlf_v1_free(model)
end program
