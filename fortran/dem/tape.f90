!> A walk through the memory of a state: the same walk counts its bytes, writes them and reads them back.
module dem_tape
   use, intrinsic :: iso_c_binding, only : c_f_pointer, c_int8_t, c_int64_t, c_loc
   implicit none
   private
   public :: tape, measuring, saving, loading, per_word

   integer, parameter :: per_word = 8       !! bytes
   integer, parameter :: per_byte = 8       !! bits
   integer, parameter :: measuring = 0, saving = 1, loading = 2

   !> Where the walk stands
   type :: tape
      integer(c_int8_t), pointer :: bytes(:) => null()
      integer(c_int64_t) :: at = 0
      integer :: mode = measuring
      logical :: short = .false.            !! there were fewer bytes than the state has
   contains
      procedure :: pass
   end type tape

contains

   !> Count, write or read the bytes of one part
   subroutine pass(on, part, bits)
      class(tape), intent(inout) :: on
      type(*), intent(inout), target, contiguous :: part(..)
      integer, intent(in) :: bits           !! of one element
      integer(c_int8_t), pointer :: bytes(:)
      integer(c_int64_t) :: count
      count = size(part, kind=c_int64_t) * (bits / per_byte)
      if (on%mode /= measuring .and. count > 0) then
         on%short = on%short .or. on%at + count > size(on%bytes, kind=c_int64_t)
         if (on%short) return
         call c_f_pointer(c_loc(part), bytes, [count])
         if (on%mode == saving) then
            on%bytes(on%at + 1:on%at + count) = bytes
         else
            bytes = on%bytes(on%at + 1:on%at + count)
         end if
      end if
      on%at = on%at + count
   end subroutine pass

end module dem_tape
